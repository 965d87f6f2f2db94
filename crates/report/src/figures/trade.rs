//! Figure of a trade: cost of a run against bias.
use crate::text::{relative, relative_size};
use stochc_experiments::trade::{CLOSE, CandidateResult, Convergence, Trade};
use stochc_runtime::{Model, Precision};
use stochc_text::{percent, seconds};

use super::EDGE;
use crate::svg::letters::{fitted, width};
use crate::svg::{
    Drawing, LINE, LegendEntry, LegendSymbol, Marker, Medium, PlotAxis, Scale, Style, plot_height,
};
use crate::tables::trade::RESTRICTED;

/// Width of the figure on a page \[units of the drawing\].
const WIDTH: f64 = 1020.0;
/// Smallest width of a figure with the list of settings to the right of the plot. In narrower
/// figures, the list is below.
const BESIDE: f64 = 840.0;
/// Width of the list of settings, in units of a drawing.
const LIST: f64 = 420.0;
/// Largest bias on the linear part of the scale. The scale is logarithmic for larger biases.
const SMALL: f64 = 0.02;
/// Dash pattern of the line through Pareto-optimal settings.
const FRONT: &str = "5 4";
/// Half the size of a mark, in units of a drawing.
const MARK: f64 = 5.5;
/// Height of a line in the list of settings, in units of a drawing.
const ROW: f64 = 19.0;

/// Candidate setting with its position in the figure.
struct PlottedSetting<'a> {
    /// Number of the setting in tables and in the figure, from 1.
    number: usize,
    candidate: &'a CandidateResult,
    reference: bool,
    /// CPU time of a run \[s\].
    cost: f64,
    /// Absolute value of the bias.
    bias: f64,
    /// Half-width of the 95 % interval of the bias.
    half_width: f64,
}

struct Axes {
    cost: Scale,
    /// Largest bias on the vertical axis.
    most: f64,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Axes {
    /// Returns the vertical position of a bias: linear for small biases, logarithmic for large
    /// ones.
    fn y(&self, bias: f64) -> f64 {
        let scale = |bias: f64| (bias / SMALL).asinh();
        let share = scale(bias.clamp(0.0, self.most)) / scale(self.most);
        self.bottom - (self.bottom - self.top) * share
    }
}

/// Draws the figure of a trade. Each mark is a candidate setting, at its CPU time per run and its
/// largest bias for any program.
pub fn trade(medium: Medium, trade: &Trade) -> Drawing {
    let points = points(trade);
    let names: Vec<&str> = trade.programs.iter().map(|p| p.name.as_str()).collect();
    let title = format!("Speed against accuracy: {}", names.join(", "));
    let below = match trade.reference.as_ref().zip(trade.reference_candidate()) {
        None => "no reference".to_owned(),
        Some((reference, candidate)) => {
            let known = match reference.convergence {
                Convergence::Converged => format!("converged within {}", percent(CLOSE)),
                Convergence::Undecided => "convergence undecided".to_owned(),
                Convergence::NotConverged => "NOT CONVERGED".to_owned(),
            };
            format!("reference: {}, {known}", candidate.options)
        }
    };
    let all = medium.width_or(WIDTH);
    let is_beside = all >= BESIDE;
    let mut out = Drawing::sized(medium, all, "trade", &title, &below);
    let text = all - 2.0 * EDGE;
    let foot = out.paragraph("ink", (EDGE, 20.0), text, &heading(&names));
    let foot = out.paragraph("dim", (EDGE, foot + 3.0), text, &below);
    let of = PlotAxis::new("size of the bias of the mean time", BIAS_UNIT);
    let top = foot - LINE + out.head(&of.label());
    let right = if is_beside { all - LIST } else { all - 18.0 };
    let axes = axes(&points, (56.0, right), top);
    let foot = frame(&mut out, &axes, &of);
    front(&mut out, &axes, &points);
    for point in &points {
        draw(&mut out, &axes, point);
    }
    numbers(&mut out, &axes, &points);
    let end = if is_beside {
        list(&mut out, &points, (right + 30.0, axes.top)).max(foot)
    } else {
        list(&mut out, &points, (EDGE, foot + 4.0))
    };
    out.high(end - 8.0)
}

/// Unit of the bias in the label of the vertical axis.
const BIAS_UNIT: &str = "% of the reference, logarithmic above 2";

fn heading(names: &[&str]) -> String {
    match names {
        [one] => format!("{one}: cost and bias of each setting"),
        _ => format!(
            "{} programs: cost and largest bias of each setting",
            names.len()
        ),
    }
}

fn points(trade: &Trade) -> Vec<PlottedSetting<'_>> {
    let reference = trade
        .reference
        .as_ref()
        .map(|reference| reference.candidate);
    let point = |(i, candidate): (usize, &'_ _)| {
        let candidate: &CandidateResult = candidate;
        let itself = reference == Some(i);
        let (bias, half_width) = match (itself, candidate.worst) {
            (true, _) => (0.0, 0.0),
            (false, Some(worst)) => (worst.value.abs(), worst.half_width.unwrap_or(0.0)),
            (false, None) => return None,
        };
        let cost = candidate.cost.filter(|cost| *cost > 0.0)?;
        Some((i + 1, itself, cost, bias, half_width))
    };
    let found = trade
        .candidates
        .iter()
        .enumerate()
        .filter_map(|(i, candidate)| {
            let (number, reference, cost, bias, half_width) = point((i, candidate))?;
            Some(PlottedSetting {
                number,
                candidate,
                reference,
                cost,
                bias,
                half_width,
            })
        });
    found.collect()
}

fn axes(points: &[PlottedSetting], (left, right): (f64, f64), top: f64) -> Axes {
    let costs = || points.iter().map(|point| point.cost.log10());
    let (least, most) = (
        costs().fold(f64::INFINITY, f64::min),
        costs().fold(f64::NEG_INFINITY, f64::max),
    );
    let (least, most) = if points.is_empty() {
        (-3.0, 0.0)
    } else {
        (least, most)
    };
    let margin = (0.06 * (most - least)).max(0.15);
    let biases = points.iter().map(|point| point.bias);
    let largest = biases.fold(0.01, f64::max);
    // Long intervals are cut off, so that they do not compress the other ones.
    let ends = points.iter().map(|point| point.bias + point.half_width);
    let reach = ends.fold(largest, f64::max).min(2.0 * largest);
    let ends = (10f64.powf(least - margin), 10f64.powf(most + margin));
    Axes {
        cost: Scale::logarithmic(ends, (left, right)),
        most: 1.08 * reach,
        left,
        right,
        top,
        bottom: top + plot_height(1.8 * (right - left)),
    }
}

/// Draws axes and grid lines. Returns the baseline of the next line of text.
fn frame(out: &mut Drawing, axes: &Axes, of: &PlotAxis) -> f64 {
    let Axes {
        left,
        right,
        top,
        bottom,
        ..
    } = *axes;
    let costs: Vec<(f64, String)> = (axes.cost.ticks(6).into_iter())
        .map(|cost| (axes.cost.at(cost), plain(cost)))
        .collect();
    for (x, _) in &costs {
        out.line("grid", (*x, top), (*x, bottom));
    }
    let steps = [
        0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4,
    ];
    let mut last = bottom;
    let mut biases = vec![(bottom, "0".to_owned())];
    for percent in steps {
        let y = axes.y(percent / 100.0);
        if percent / 100.0 > axes.most || last - y < 22.0 {
            continue;
        }
        last = y;
        out.line("grid", (left, y), (right, y));
        biases.push((y, percent.to_string()));
    }
    out.marks_upward(&biases, (bottom, top), (EDGE, left), &of.label());
    let of = PlotAxis::new("CPU time of a run, median", "s, ms or us as marked");
    out.marks_across(&costs, (left, right), bottom, &of.on(&axes.cost))
}

/// Returns a CPU time without trailing zeros.
fn plain(cost: f64) -> String {
    let text = seconds(cost);
    let (number, unit) = text.split_once(' ').unwrap_or((&text, ""));
    let number = if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    };
    format!("{number} {unit}")
}

fn front(out: &mut Drawing, axes: &Axes, points: &[PlottedSetting]) {
    let mut best: Vec<&PlottedSetting> = points
        .iter()
        .filter(|point| point.candidate.front)
        .collect();
    best.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let position = |point: &&PlottedSetting| (axes.cost.at(point.cost), axes.y(point.bias));
    let path: Vec<(f64, f64)> = best.iter().map(position).collect();
    if path.len() > 1 {
        out.curve("mark", &path, FRONT);
    }
}

/// Returns the class and the shape of a candidate's mark.
fn look(point: &PlottedSetting) -> (&'static str, Marker) {
    let settings = &point.candidate.settings;
    let symbol = match settings.model {
        _ if point.reference => Marker::Diamond,
        _ if point.candidate.reduced() => Marker::Triangle,
        Model::Rapier => Marker::Square,
        _ if settings.precision == Precision::Double => Marker::Ring,
        _ => Marker::Disc,
    };
    let class = match symbol {
        Marker::Diamond => "reference",
        _ if point.candidate.reversed => "hot",
        Marker::Triangle => "s2",
        Marker::Square => "s1",
        _ if settings.model == Model::Rate => "s3",
        _ => "s0",
    };
    (class, symbol)
}

fn draw(out: &mut Drawing, axes: &Axes, point: &PlottedSetting) {
    let (x, y) = (axes.cost.at(point.cost), axes.y(point.bias));
    let (class, symbol) = look(point);
    if point.half_width > 0.0 {
        let (low, high) = (point.bias - point.half_width, point.bias + point.half_width);
        let style = Style::line(1.4).faint(0.55);
        out.stroke(class, (x, axes.y(low)), (x, axes.y(high)), style);
    }
    let cost = seconds(point.cost);
    let tooltip = match (point.reference, point.candidate.worst) {
        (false, Some(worst)) => {
            format!("{}: {}, {cost}", point.candidate.options, relative(&worst))
        }
        _ => format!("{}: the reference, {cost}", point.candidate.options),
    };
    out.mark(&format!("mark {class}"), symbol, (x, y), MARK, &tooltip);
}

/// Draws the number of each mark at the position with the least overlap.
fn numbers(out: &mut Drawing, axes: &Axes, points: &[PlottedSetting]) {
    let positions: Vec<(f64, f64)> = points
        .iter()
        .map(|p| (axes.cost.at(p.cost), axes.y(p.bias)))
        .collect();
    let mut taken: Vec<(f64, f64, f64)> =
        positions.iter().map(|&(x, y)| (x, y, MARK + 1.0)).collect();
    for (point, &(x, y)) in points.iter().zip(&positions) {
        let label = point.number.to_string();
        let half = width(&label) / 2.0;
        let (dx, dy) = (MARK + half + 4.0, MARK + 9.0);
        let around = [
            (dx, 0.0),
            (-dx, 0.0),
            (0.0, -dy),
            (0.0, dy),
            (dx, -dy),
            (-dx, -dy),
            (dx, dy),
            (-dx, dy),
        ];
        let far = around.iter().map(|(dx, dy)| (1.8 * dx, 1.8 * dy));
        let candidates = around.iter().copied().chain(far);
        let covered = |&(dx, dy): &(f64, f64)| {
            let (cx, cy) = (x + dx, y + dy);
            let inside = (axes.left + 4.0..=axes.right).contains(&cx)
                && (axes.top..=axes.bottom - 4.0).contains(&cy);
            let hits = taken.iter().filter(|(tx, ty, size)| {
                (cx - tx).abs() < half + size && (cy - ty).abs() < 5.0 + size
            });
            hits.count() + if inside { 0 } else { 2 }
        };
        let (dx, dy) = candidates.min_by_key(covered).unwrap_or((dx, 0.0));
        taken.push((x + dx, y + dy, half));
        let position = (x + dx, y + dy + 4.0);
        out.text_around("ink halo", position, &label);
    }
}

/// Draws the settings with their numbers, and the meaning of the marks. `(x, y)` is the start of
/// the first line of text. Returns the baseline after the last line.
fn list(out: &mut Drawing, points: &[PlottedSetting], (x, y): (f64, f64)) -> f64 {
    let right = out.size().0 - EDGE;
    let mut y = y;
    let mut is_any_restricted = false;
    out.text("dim", (x, y), "setting: model, substeps");
    for point in points {
        y += ROW;
        out.text_before("dim", (x + 16.0, y), &point.number.to_string());
        let bias = match point.candidate.worst.filter(|_| !point.reference) {
            Some(worst) if worst.horizon.is_some() => {
                is_any_restricted = true;
                format!("{RESTRICTED}{}", relative_size(&worst))
            }
            Some(worst) => relative_size(&worst),
            None => String::new(),
        };
        let name = match (point.reference, point.candidate.reversed) {
            (true, _) => format!("{} (reference)", point.candidate.name),
            (false, true) => format!("{} REVERSED", point.candidate.name),
            (false, false) => point.candidate.name.clone(),
        };
        let colour = if point.candidate.reversed {
            "hot word"
        } else {
            "ink"
        };
        let room = right - (x + 24.0) - width(&bias) - 8.0;
        out.text(colour, (x + 24.0, y), &fitted(&name, room));
        out.text_before("dim", (right, y), &bias);
    }
    y += 1.6 * ROW;
    let key = |class: &str, sample, meaning: &str| LegendEntry {
        class: class.to_owned(),
        sample,
        meaning: meaning.to_owned(),
    };
    let mark = |class: &str, marker, meaning: &str| {
        key(&format!("key {class}"), LegendSymbol::Mark(marker), meaning)
    };
    let keys = [
        mark("s0", Marker::Disc, "rigid (open: double precision)"),
        mark("s1", Marker::Square, "Rapier"),
        mark("s3", Marker::Disc, "rate model"),
        mark("s2", Marker::Triangle, "reduced model"),
        mark(
            "hot",
            Marker::Triangle,
            "red: reverses the order of two programs",
        ),
        mark("reference", Marker::Diamond, "reference"),
        key(
            "mark",
            LegendSymbol::Line(FRONT),
            "Pareto-optimal: no setting is cheaper and less biased",
        ),
    ];
    let foot = out.keys((x, y), right, &keys);
    out.text("dim", (x, foot), "bars: 95 % interval of the bias");
    let mut foot = foot + ROW;
    if is_any_restricted {
        let meaning = format!("{RESTRICTED}of times up to a horizon, no bound");
        out.text("dim", (x, foot), &meaning);
        foot += ROW;
    }
    foot
}
