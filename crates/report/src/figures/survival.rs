//! Curves of the share of incomplete runs.
use stochc_experiments::statistics::{KaplanMeier, Observation, SurvivalPoint};
use stochc_text::percent_number;

use super::EDGE;
use crate::svg::letters::{fitted, width};
use crate::svg::{Colours, Drawing, LINE, Medium, PlotAxis, Scale, dashes, plot_height};

/// Data of one curve in a figure.
#[derive(Clone, Debug)]
pub(crate) struct SurvivalCurve {
    pub name: String,
    /// Times of the runs, in the unit of the axis.
    pub times: Vec<Observation>,
}

/// Returns the default vertical axis: the share of incomplete runs.
pub(crate) fn incomplete() -> PlotAxis {
    PlotAxis::new("runs not complete yet", "%")
}

/// Draws Kaplan-Meier curves with their intervals. Marks show stopped runs. Numbers below the time
/// axis show how many runs are under observation. `axis` is the axis of times, and `of` the axis of
/// shares.
pub(crate) fn survival(
    medium: Medium,
    name: &str,
    title: &str,
    curves: &[SurvivalCurve],
    (axis, of): (&PlotAxis, &PlotAxis),
    colours: Colours,
) -> Option<Drawing> {
    const RISK: &str = "at risk";
    const ROW: f64 = 19.0;
    /// Largest number of curves with bands for their intervals. More bands would hide each other.
    const BANDS: usize = 4;
    /// Largest number of marks in a figure. A browser draws this number without delay.
    const MARKS: usize = 2000;
    let known: Vec<_> = (curves.iter().enumerate())
        .filter_map(|(i, curve)| Some((i, curve, KaplanMeier::new(&curve.times)?)))
        .collect();
    let last = known.iter().map(|(_, _, estimate)| estimate.last());
    let last = last.fold(0.0, f64::max);
    if last <= 0.0 {
        return None;
    }
    let mut out = Drawing::new(medium, name, title, &description(&known, axis));
    // The first number under observation stands next to the label.
    let most = curves.iter().map(|curve| curve.times.len()).max();
    let most = width(&most.unwrap_or(0).to_string());
    let left = (EDGE + width(RISK) + 8.0 + most / 2.0).max(58.0);
    let right = medium.width() - 18.0;
    let share = (0.0, 1.0);
    let top = out.head(&of.label());
    let bottom = top + plot_height(right - left);
    let x = Scale::linear((0.0, last), (left, right));
    let y = Scale::linear(share, (bottom, top));
    let mut foot = out.across(&x, (left, right), bottom, top, axis);
    out.upward(&y, (bottom, top), left, right, of, percent_number);
    for (i, _, estimate) in known.iter().filter(|_| known.len() <= BANDS) {
        // After the last completion, the curve is unknown or 0.
        let points: Vec<_> = (thinned(estimate, &x).iter())
            .map_while(|point| Some((point.time, point.interval?)))
            .collect();
        let Some(&(first, _)) = points.first() else {
            continue;
        };
        let end = match estimate.incomplete(estimate.last()) {
            0.0 => estimate.curve().last().map_or(first, |point| point.time),
            _ => estimate.last(),
        };
        let mut low = Vec::new();
        let mut high = Vec::new();
        for (k, &(time, (below, above))) in points.iter().enumerate() {
            let until = points.get(k + 1).map_or(end, |next| next.0);
            low.extend([(x.at(time), y.at(below)), (x.at(until), y.at(below))]);
            high.extend([(x.at(time), y.at(above)), (x.at(until), y.at(above))]);
        }
        high.extend(low.into_iter().rev());
        out.area(colours.class(*i), &high);
    }
    for (i, curve, estimate) in &known {
        let mut points = vec![(x.at(0.0), y.at(1.0))];
        for step in thinned(estimate, &x) {
            let before = points.last().map_or(y.at(1.0), |point| point.1);
            points.extend([
                (x.at(step.time), before),
                (x.at(step.time), y.at(step.incomplete)),
            ]);
        }
        if let Some(&(_, share)) = points.last() {
            points.push((x.at(estimate.last()), share));
        }
        let dashes = dashes(*i);
        if colours == Colours::Phases {
            out.curve("casing", &points, dashes);
        }
        out.curve(colours.class(*i), &points, dashes);
        let stopped = curve.times.iter().filter(|time| !time.is_completed());
        let mut stopped: Vec<f64> = stopped.map(|time| time.time).collect();
        if stopped.len() > MARKS {
            // Keep one of several marks that overlap completely.
            stopped.sort_by(f64::total_cmp);
            stopped.dedup_by_key(|time| column(&x, *time));
        }
        for time in stopped {
            let at = (x.at(time), y.at(estimate.incomplete(time)));
            out.line("mark", (at.0, at.1 - 5.0), (at.0, at.1 + 5.0));
        }
        let sample = [(EDGE + 2.0, foot - 4.0), (EDGE + 36.0, foot - 4.0)];
        out.curve(colours.class(*i), &sample, dashes);
        let words = EDGE + 44.0;
        foot = out.paragraph(
            "ink",
            (words, foot),
            medium.width() - words - EDGE,
            &legend(curve, estimate, axis),
        );
        foot += ROW - LINE;
        out.text("dim", (EDGE, foot), RISK);
        for tick in out.ticks_across(&x) {
            let at_risk = |time: &&Observation| time.at_risk_until() >= tick;
            let at_risk = curve.times.iter().filter(at_risk).count();
            out.text_around("dim", (x.at(tick), foot), &at_risk.to_string());
        }
        foot += ROW + 2.0;
    }
    Some(out.high(foot - 8.0))
}

/// Returns the steps of a curve that can be distinguished: the last one within each third of a
/// drawing unit.
fn thinned(estimate: &KaplanMeier, x: &Scale) -> Vec<SurvivalPoint> {
    let mut points: Vec<SurvivalPoint> = Vec::new();
    for point in estimate.curve() {
        if points
            .last()
            .is_some_and(|last| column(x, last.time) == column(x, point.time))
        {
            points.pop();
        }
        points.push(point);
    }
    points
}

/// Returns the horizontal position of a time, in thirds of a drawing unit.
fn column(x: &Scale, time: f64) -> i64 {
    (3.0 * x.at(time)) as i64
}

fn legend(curve: &SurvivalCurve, estimate: &KaplanMeier, axis: &PlotAxis) -> String {
    let stopped = curve
        .times
        .iter()
        .filter(|time| !time.is_completed())
        .count();
    let half = match estimate.median() {
        Some(median) => format!("half complete at {}", axis.value(median)),
        None => "fewer than half complete".to_owned(),
    };
    let stopped = match stopped {
        0 => String::new(),
        n => format!(", {n} stopped before (|)"),
    };
    format!(
        "{}: {half}; {} runs{stopped}",
        fitted(&curve.name, 260.0),
        curve.times.len()
    )
}

fn description(known: &[(usize, &SurvivalCurve, KaplanMeier)], axis: &PlotAxis) -> String {
    let each = known
        .iter()
        .map(|(_, curve, estimate)| legend(curve, estimate, axis));
    format!(
        "Each curve falls in steps from 100 %. {}.",
        each.collect::<Vec<_>>().join(". ")
    )
}
