//! A trade as a picture: what a run costs against how far it is off.
use std::fmt::Write as _;

use stochc_runtime::{Model, Precision};

use super::advice::{percent, relative, within};
use super::refine::{CLOSE, Convergence};
use super::report::{Rung, Trade};
use crate::figures::seconds;
use crate::figures::{escaped, line, text};

const WIDTH: f64 = 1020.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 600.0;
const TOP: f64 = 60.0;
const BOTTOM: f64 = 540.0;
/// Biases below this are drawn to scale, larger ones by their logarithm.
const SMALL: f64 = 0.02;
/// Half the size of a mark.
const MARK: f64 = 5.5;
/// Height of a line of the list of settings.
const ROW: f64 = 19.0;

const STYLE: &str = "\
.paper{fill:#fcfcfa}.ink{fill:#222}.dim{fill:#666}.line{stroke:#666}.grid{stroke:#e2e2de}\
.front{stroke:#222}.rigid{fill:#2a6fb0;stroke:#2a6fb0}.rapier{fill:#b07a12;stroke:#b07a12}\
.reduced{fill:#2f8f5b;stroke:#2f8f5b}.reversed{fill:#d0202e;stroke:#d0202e}\
.words{fill:#d0202e}.number{fill:#222;stroke:#fcfcfa;stroke-width:3;paint-order:stroke}.reference{fill:#222;stroke:#222}\
@media (prefers-color-scheme:dark){\
.paper{fill:#15171c}.ink{fill:#e8e8e4}.dim{fill:#a0a4ab}.line{stroke:#a0a4ab}.grid{stroke:#2c3038}\
.front{stroke:#e8e8e4}.rigid{fill:#6db3f2;stroke:#6db3f2}.rapier{fill:#e0b04a;stroke:#e0b04a}\
.reduced{fill:#6fd09a;stroke:#6fd09a}.reversed{fill:#ff6b76;stroke:#ff6b76}\
.words{fill:#ff6b76}.number{fill:#e8e8e4;stroke:#15171c}.reference{fill:#e8e8e4;stroke:#e8e8e4}}";

/// A rung that has a place in the picture.
struct Point<'a> {
    /// As in the tables, from 1.
    number: usize,
    rung: &'a Rung,
    reference: bool,
    /// Cost of a run \[s\].
    cost: f64,
    /// Size of the bias and half of its interval.
    bias: f64,
    half_width: f64,
}

/// Where values are drawn.
struct Axes {
    /// Decimal logarithms of the costs at both ends.
    from: f64,
    to: f64,
    /// The largest bias.
    most: f64,
}

impl Axes {
    fn x(&self, cost: f64) -> f64 {
        LEFT + (RIGHT - LEFT) * (cost.log10() - self.from) / (self.to - self.from)
    }

    /// Small biases to scale and large ones by their logarithm, so that both can be told apart.
    fn y(&self, bias: f64) -> f64 {
        let scale = |bias: f64| (bias / SMALL).asinh();
        let share = scale(bias.clamp(0.0, self.most)) / scale(self.most);
        BOTTOM - (BOTTOM - TOP) * share
    }
}

/// Draws a trade: each mark is a setting, at the cost of a run and the largest bias of any program.
pub fn svg(trade: &Trade) -> String {
    let points = points(trade);
    let axes = axes(&points);
    let rows = points.len() as f64;
    let height = (TOP + ROW * (rows + 9.0)).max(BOTTOM + 70.0);
    let names: Vec<&str> = trade.programs.iter().map(|p| p.name.as_str()).collect();
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" \
         width=\"{WIDTH}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" role=\"img\">\n\
         <title>What accuracy costs: {}</title>\n<style>{STYLE}</style>\n\
         <rect class=\"paper\" width=\"100%\" height=\"100%\"/>",
        escaped(&names.join(", "))
    );
    text(
        &mut out,
        "ink",
        (LEFT, 26.0),
        "font-size=\"15\"",
        &heading(&names),
    );
    let below = match trade.reference.as_ref().zip(trade.reference_rung()) {
        None => "nothing to hold it against".to_owned(),
        Some((reference, rung)) => {
            let known = match reference.convergence {
                Convergence::Converged => format!("converged within {}", percent(CLOSE)),
                Convergence::Undecided => "convergence undecided".to_owned(),
                Convergence::NotConverged => "NOT CONVERGED".to_owned(),
            };
            format!("reference: {}, {known}", rung.options)
        }
    };
    text(&mut out, "dim", (LEFT, 44.0), "", &below);
    frame(&mut out, &axes);
    front(&mut out, &axes, &points);
    for point in &points {
        draw(&mut out, &axes, point);
    }
    numbers(&mut out, &axes, &points);
    list(&mut out, &points);
    out += "</svg>\n";
    out
}

fn heading(names: &[&str]) -> String {
    match names {
        [one] => format!("{one}: cost and bias of each setting"),
        _ => format!(
            "{} programs: cost and largest bias of each setting",
            names.len()
        ),
    }
}

fn points(trade: &Trade) -> Vec<Point<'_>> {
    let reference = trade.reference.as_ref().map(|reference| reference.rung);
    let point = |(i, rung): (usize, &'_ _)| {
        let rung: &Rung = rung;
        let itself = reference == Some(i);
        let (bias, half_width) = match (itself, rung.worst) {
            (true, _) => (0.0, 0.0),
            (false, Some(worst)) => (worst.value.abs(), worst.half_width.unwrap_or(0.0)),
            (false, None) => return None,
        };
        let cost = rung.cost.filter(|cost| *cost > 0.0)?;
        Some((i + 1, itself, cost, bias, half_width))
    };
    let found = trade.rungs.iter().enumerate().filter_map(|(i, rung)| {
        let (number, reference, cost, bias, half_width) = point((i, rung))?;
        Some(Point {
            number,
            rung,
            reference,
            cost,
            bias,
            half_width,
        })
    });
    found.collect()
}

fn axes(points: &[Point]) -> Axes {
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
    // A long interval may be cut off, so that it does not push all others together.
    let ends = points.iter().map(|point| point.bias + point.half_width);
    let reach = ends.fold(largest, f64::max).min(2.0 * largest);
    Axes {
        from: least - margin,
        to: most + margin,
        most: 1.08 * reach,
    }
}

fn frame(out: &mut String, axes: &Axes) {
    for decade in axes.from.floor() as i32..=axes.to.ceil() as i32 {
        for digit in [1.0, 2.0, 5.0] {
            let cost: f64 = digit * 10f64.powi(decade);
            if cost.log10() < axes.from || cost.log10() > axes.to {
                continue;
            }
            let x = axes.x(cost);
            line(out, "grid", (x, TOP), (x, BOTTOM), "");
            text(
                out,
                "dim",
                (x, BOTTOM + 18.0),
                "text-anchor=\"middle\"",
                &plain(cost),
            );
        }
    }
    let steps = [
        0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4,
    ];
    let mut last = BOTTOM;
    line(out, "line", (LEFT, BOTTOM), (RIGHT, BOTTOM), "");
    text(
        out,
        "dim",
        (LEFT - 8.0, BOTTOM + 4.0),
        "text-anchor=\"end\"",
        "0",
    );
    for percent in steps {
        let y = axes.y(percent / 100.0);
        if percent / 100.0 > axes.most || last - y < 22.0 {
            continue;
        }
        last = y;
        line(out, "grid", (LEFT, y), (RIGHT, y), "");
        text(
            out,
            "dim",
            (LEFT - 8.0, y + 4.0),
            "text-anchor=\"end\"",
            &percent.to_string(),
        );
    }
    line(out, "line", (LEFT, TOP), (LEFT, BOTTOM), "");
    let middle = (LEFT + RIGHT) / 2.0;
    let label = "processor time of a run, median (logarithmic)";
    text(
        out,
        "ink",
        (middle, BOTTOM + 42.0),
        "text-anchor=\"middle\"",
        label,
    );
    let (x, y) = (22.0, (TOP + BOTTOM) / 2.0);
    let turn = format!("text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\"");
    let label = "|bias| of the mean time, % of the reference (logarithmic above 2)";
    text(out, "ink", (x, y), &turn, label);
}

/// A time without needless zeros.
fn plain(cost: f64) -> String {
    let text = seconds(cost);
    let (number, unit) = text.split_once(' ').unwrap_or((&text, ""));
    let number = match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.'),
        false => number,
    };
    format!("{number} {unit}")
}

fn front(out: &mut String, axes: &Axes, points: &[Point]) {
    let mut best: Vec<&Point> = points.iter().filter(|point| point.rung.front).collect();
    best.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let places = best
        .iter()
        .map(|point| (axes.x(point.cost), axes.y(point.bias)));
    let path: Vec<String> = places.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    if path.len() > 1 {
        let _ = writeln!(
            out,
            "<polyline class=\"front\" points=\"{}\" fill=\"none\" stroke-width=\"1.2\" \
             stroke-dasharray=\"5 4\"/>",
            path.join(" ")
        );
    }
}

fn class(point: &Point) -> &'static str {
    if point.reference {
        "reference"
    } else if point.rung.reversed {
        "reversed"
    } else if point.rung.reduced() {
        "reduced"
    } else if point.rung.settings.model == Model::Rapier {
        "rapier"
    } else {
        "rigid"
    }
}

fn draw(out: &mut String, axes: &Axes, point: &Point) {
    let (x, y) = (axes.x(point.cost), axes.y(point.bias));
    let class = class(point);
    if point.half_width > 0.0 {
        let (low, high) = (point.bias - point.half_width, point.bias + point.half_width);
        let style = "stroke-width=\"1.4\" opacity=\"0.55\"";
        line(out, class, (x, axes.y(low)), (x, axes.y(high)), style);
    }
    let cost = seconds(point.cost);
    let told = match (point.reference, point.rung.worst) {
        (false, Some(worst)) => format!("{}: {}, {cost}", point.rung.options, relative(&worst)),
        _ => format!("{}: the reference, {cost}", point.rung.options),
    };
    let _ = writeln!(
        out,
        "<g class=\"mark {class}\"><title>{}</title>{}</g>",
        escaped(&told),
        shape(point, x, y)
    );
}

/// A circle for `rigid`, an open one in double precision, a square for Rapier, a triangle for a
/// reduced model, a diamond for the reference.
fn shape(point: &Point, x: f64, y: f64) -> String {
    let polygon = |corners: &[(f64, f64)]| {
        let corners = corners
            .iter()
            .map(|(dx, dy)| format!("{:.1},{:.1}", x + dx, y + dy));
        format!(
            "<polygon points=\"{}\"/>",
            corners.collect::<Vec<_>>().join(" ")
        )
    };
    let m = MARK;
    let settings = &point.rung.settings;
    if point.reference {
        polygon(&[
            (0.0, -1.4 * m),
            (1.4 * m, 0.0),
            (0.0, 1.4 * m),
            (-1.4 * m, 0.0),
        ])
    } else if point.rung.reduced() {
        polygon(&[(0.0, -1.2 * m), (1.15 * m, 0.9 * m), (-1.15 * m, 0.9 * m)])
    } else if settings.model == Model::Rapier {
        polygon(&[(-m, -m), (m, -m), (m, m), (-m, m)])
    } else if settings.precision == Precision::Double {
        format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{m}\" fill=\"none\" stroke-width=\"2\"/>")
    } else {
        format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{m}\"/>")
    }
}

/// Numbers beside the marks, each where it covers the least.
fn numbers(out: &mut String, axes: &Axes, points: &[Point]) {
    /// Of a digit.
    const DIGIT: f64 = 7.0;
    let places: Vec<(f64, f64)> = points
        .iter()
        .map(|p| (axes.x(p.cost), axes.y(p.bias)))
        .collect();
    let mut taken: Vec<(f64, f64, f64)> = places.iter().map(|&(x, y)| (x, y, MARK + 1.0)).collect();
    for (point, &(x, y)) in points.iter().zip(&places) {
        let label = point.number.to_string();
        let half = DIGIT * label.len() as f64 / 2.0;
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
            let inside = (LEFT + 4.0..=RIGHT).contains(&cx) && (TOP..=BOTTOM - 4.0).contains(&cy);
            let hits = taken.iter().filter(|(tx, ty, size)| {
                (cx - tx).abs() < half + size && (cy - ty).abs() < 5.0 + size
            });
            hits.count() + if inside { 0 } else { 2 }
        };
        let (dx, dy) = candidates.min_by_key(covered).unwrap_or((dx, 0.0));
        taken.push((x + dx, y + dy, half));
        let place = (x + dx, y + dy + 4.0);
        text(
            out,
            "number",
            place,
            "text-anchor=\"middle\" font-size=\"11\"",
            &label,
        );
    }
}

/// The settings by their numbers, and what the marks mean.
fn list(out: &mut String, points: &[Point]) {
    const X: f64 = RIGHT + 30.0;
    let mut y = TOP;
    text(out, "dim", (X, y), "", "setting: model, substeps");
    for point in points {
        y += ROW;
        let end = "text-anchor=\"end\"";
        text(out, "dim", (X + 16.0, y), end, &point.number.to_string());
        let name = match (point.reference, point.rung.reversed) {
            (true, _) => format!("{} (reference)", point.rung.name),
            (false, true) => format!("{} REVERSED", point.rung.name),
            (false, false) => point.rung.name.clone(),
        };
        let colour = if point.rung.reversed { "words" } else { "ink" };
        text(out, colour, (X + 24.0, y), "", &name);
        if let Some(worst) = point.rung.worst.filter(|_| !point.reference) {
            text(out, "dim", (WIDTH - 14.0, y), end, &within(&worst));
        }
    }
    y += 1.6 * ROW;
    let m = MARK;
    let meanings = [
        (
            "rigid",
            format!("<circle cx=\"{X}\" cy=\"0\" r=\"{m}\"/>"),
            "rigid; open: double precision",
        ),
        ("rapier", square(X), "Rapier"),
        ("reduced", triangle(X), "reduced model"),
        (
            "reversed",
            triangle(X),
            "red: it reverses an order of programs",
        ),
        ("reference", diamond(X), "reference"),
    ];
    for (class, shape, meaning) in meanings {
        let _ = writeln!(
            out,
            "<g class=\"key {class}\" transform=\"translate(8 {:.1})\">{shape}</g>",
            y - 4.0
        );
        text(out, "dim", (X + 24.0, y), "", meaning);
        y += ROW;
    }
    line(
        out,
        "front",
        (X, y - 4.0),
        (X + 16.0, y - 4.0),
        "stroke-dasharray=\"5 4\"",
    );
    text(
        out,
        "dim",
        (X + 24.0, y),
        "",
        "no setting is cheaper and less biased",
    );
    text(
        out,
        "dim",
        (X + 24.0, y + ROW),
        "",
        "bars: 95 % interval of the bias",
    );
}

fn square(x: f64) -> String {
    let (side, corner) = (2.0 * MARK, x - MARK);
    format!("<rect x=\"{corner}\" y=\"-{MARK}\" width=\"{side}\" height=\"{side}\"/>")
}

fn triangle(x: f64) -> String {
    let (top, right, left, foot) = (-1.2 * MARK, x + 1.15 * MARK, x - 1.15 * MARK, 0.9 * MARK);
    format!("<polygon points=\"{x},{top:.1} {right:.1},{foot:.1} {left:.1},{foot:.1}\"/>")
}

fn diamond(x: f64) -> String {
    let m = 1.4 * MARK;
    format!(
        "<polygon points=\"{x},-{m:.1} {:.1},0 {x},{m:.1} {:.1},0\"/>",
        x + m,
        x - m
    )
}
