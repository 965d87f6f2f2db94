//! Figure of a fit: the posterior of each parameter, and the predicted times.
use stochc_experiments::fit::{Fit, Interval, Prediction, Prior, Unit};
use stochc_text::number;

use super::EDGE;
use crate::svg::letters::{fitted, widest};
use crate::svg::{Drawing, LINE, Medium, PlotAxis, Scale, Style};

/// Height of the panel of a parameter, in units of a drawing.
const PANEL: f64 = 130.0;
/// Height of the row of a program, in units of a drawing.
const ROW: f64 = 26.0;
/// Number of bins of a histogram.
const BINS: usize = 40;

/// Draws the posterior of each parameter as a histogram over its prior range. Draws measured means
/// next to predicted means.
pub fn fit(medium: Medium, fit: &Fit, priors: &[Prior]) -> Drawing {
    let numbers: Vec<String> = (fit.numbers.iter())
        .map(|it| {
            format!(
                "{}: {} to {}",
                it.name,
                number(it.interval.0),
                number(it.interval.1)
            )
        })
        .collect();
    let title = "Scene parameters that fit the measured times";
    let mut out = Drawing::new(medium, "fit", title, &numbers.join("; "));
    let mut foot = out.paragraph("ink", (EDGE, 22.0), medium.width() - 2.0 * EDGE, title);
    for (prior, (i, known)) in priors.iter().zip(fit.numbers.iter().enumerate()) {
        let median = format!(
            "{}: {} ({} .. {})",
            known.name,
            number(known.median),
            number(known.interval.0),
            number(known.interval.1)
        );
        let beside = medium.width() - 2.0 * EDGE;
        foot = out.paragraph("dim", (EDGE, foot + 4.0), beside, &median);
        foot = histogram(&mut out, fit, prior, i, foot - LINE);
    }
    let foot = predictions(&mut out, fit, foot);
    out.high(foot - 8.0)
}

/// Draws the posterior of parameter `i` as a histogram. Returns the baseline of the next line of
/// text.
fn histogram(out: &mut Drawing, fit: &Fit, prior: &Prior, i: usize, top: f64) -> f64 {
    let (bottom, known) = (top + PANEL - 50.0, &fit.numbers[i]);
    let (left, right) = (EDGE + 16.0, out.size().0 - 30.0);
    let ends = (prior.from, prior.to);
    let scale = if prior.is_logarithmic {
        Scale::logarithmic(ends, (left, right))
    } else {
        Scale::linear(ends, (left, right))
    };
    let mut counts = [0_usize; BINS];
    for draw in &fit.draws {
        let share = (scale.at(draw[i]) - left) / (right - left);
        counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1) as f64;
    let width = (right - left) / BINS as f64;
    for (bin, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let height = (bottom - top - 8.0) * *count as f64 / most;
        let corner = (left + width * bin as f64, bottom - height);
        out.rectangle("bar s0", corner, (width - 0.5, height), "");
    }
    let of = PlotAxis::new(&known.name, &known.unit);
    out.across(&scale, (left, right), bottom, bottom, &of)
}

/// Draws measured and predicted mean times. Returns the baseline of the next line of text.
fn predictions(out: &mut Drawing, fit: &Fit, top: f64) -> f64 {
    let ends = fit.predictions.iter().flat_map(|it| {
        let measured = it.measurement.observed.as_ref().map_or(0.0, |it| it.mean);
        [it.mean.high, measured]
    });
    let most = ends.fold(0.0, f64::max);
    let name = |it: &Prediction| match (&it.measurement.observed, it.measurement.is_fitted) {
        (_, true) => it.measurement.label(),
        (Some(_), false) => format!("{} (held out)", it.measurement.label()),
        (None, false) => format!("{} (not measured)", it.measurement.program),
    };
    let names: Vec<String> = fit.predictions.iter().map(name).collect();
    let all = out.size().0;
    let column = widest(names.iter().map(String::as_str)).min(0.34 * all);
    let (left, right) = (EDGE + column + 12.0, all - 30.0);
    let scale = Scale::linear((0.0, 1.05 * most), (left, right));
    let bottom = top + ROW * fit.predictions.len() as f64 + 8.0;
    let unit = match fit.unit {
        Unit::Ticks => "ticks",
        Unit::Seconds => "s",
    };
    let of = PlotAxis::new("mean time: measured (dot) and predicted (bar, 95 %)", unit);
    let foot = out.across(&scale, (left, right), bottom, top, &of);
    for (i, (it, name)) in fit.predictions.iter().zip(&names).enumerate() {
        let y = top + ROW * (i as f64 + 0.5);
        let Interval { low, high, .. } = it.mean;
        let class = if it.measurement.is_fitted { "s0" } else { "s1" };
        let style = Style::line(5.0).faint(0.5);
        out.stroke(class, (scale.at(low), y), (scale.at(high), y), style);
        if let Some(observed) = &it.measurement.observed {
            let tooltip = format!(
                "{}: measured {}",
                it.measurement.label(),
                number(observed.mean)
            );
            out.disc("ink", (scale.at(observed.mean), y), 4.0, &tooltip);
        }
        out.text("ink", (EDGE, y + 4.0), &fitted(name, column));
    }
    foot
}
