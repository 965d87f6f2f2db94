//! What a fit knows of each number, and what it predicts.
use stochc_ensemble::fit::{Fit, Prior};
use stochc_ensemble::text::number;

use crate::svg::{Drawing, Scale};
use crate::text::short;

/// Of the figure.
const WIDTH: f64 = 760.0;
/// Height of the panel of a number.
const PANEL: f64 = 130.0;
/// Height of the row of a program.
const ROW: f64 = 26.0;
/// Columns of a histogram.
const BINS: usize = 40;

const LEFT: f64 = 190.0;
const RIGHT: f64 = WIDTH - 30.0;

/// A histogram of each number over its range, and the measured means beside those that are predicted.
pub fn fit(fit: &Fit, priors: &[Prior]) -> Drawing {
    let top = PANEL * priors.len() as f64 + 60.0;
    let height = top + ROW * fit.predictions.len() as f64 + 60.0;
    let numbers: Vec<String> = (fit.numbers.iter())
        .map(|it| {
            format!(
                "{}: {} to {}",
                it.of,
                number(it.interval.0),
                number(it.interval.1)
            )
        })
        .collect();
    let title = "Numbers that measured times speak for";
    let mut out = Drawing::new("fit", title, &numbers.join("; "), (WIDTH, height));
    out.text("ink", (20.0, 26.0), title);
    for (i, prior) in priors.iter().enumerate() {
        histogram(&mut out, fit, prior, i, 40.0 + PANEL * i as f64);
    }
    predictions(&mut out, fit, top);
    out
}

fn histogram(out: &mut Drawing, fit: &Fit, prior: &Prior, i: usize, top: f64) {
    let (bottom, known) = (top + PANEL - 50.0, &fit.numbers[i]);
    let ends = (prior.from, prior.to);
    let scale = match prior.is_logarithmic {
        true => Scale::logarithmic(ends, (LEFT, RIGHT)),
        false => Scale::linear(ends, (LEFT, RIGHT)),
    };
    let mut counts = [0_usize; BINS];
    for draw in &fit.draws {
        let share = (scale.at(draw[i]) - LEFT) / (RIGHT - LEFT);
        counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1) as f64;
    let width = (RIGHT - LEFT) / BINS as f64;
    for (bin, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let height = (bottom - top - 8.0) * *count as f64 / most;
        let corner = (LEFT + width * bin as f64, bottom - height);
        out.rectangle("bar s0", corner, (width - 0.5, height), "");
    }
    for tick in scale.ticks(6) {
        out.text_around("dim", (scale.at(tick), bottom + 17.0), &number(tick));
    }
    out.line("axis", (LEFT, bottom), (RIGHT, bottom), "");
    let label = match &*known.unit {
        "" => known.of.clone(),
        unit => format!("{} [{unit}]", known.of),
    };
    out.text_before("ink", (LEFT - 14.0, bottom - 24.0), &short(&label, 24));
    let median = format!(
        "{} ({} .. {})",
        number(known.median),
        number(known.interval.0),
        number(known.interval.1)
    );
    out.text_before("dim", (LEFT - 14.0, bottom - 8.0), &median);
}

fn predictions(out: &mut Drawing, fit: &Fit, top: f64) {
    let ends = fit.predictions.iter().flat_map(|it| {
        let (low, high) = it.mean_interval;
        [low, high, it.observed.mean]
    });
    let most = ends.fold(0.0, f64::max);
    let scale = Scale::linear((0.0, 1.05 * most), (LEFT, RIGHT));
    let bottom = top + ROW * fit.predictions.len() as f64 + 8.0;
    for tick in scale.ticks(6) {
        let x = scale.at(tick);
        out.line("grid", (x, top), (x, bottom), "");
        out.text_around("dim", (x, bottom + 17.0), &number(tick));
    }
    for (i, it) in fit.predictions.iter().enumerate() {
        let y = top + ROW * (i as f64 + 0.5);
        let (low, high) = it.mean_interval;
        let class = if it.is_fitted { "s0" } else { "s1" };
        out.line(
            class,
            (scale.at(low), y),
            (scale.at(high), y),
            "stroke-width=\"5\" opacity=\"0.5\"",
        );
        let told = format!(
            "{}: measured {}",
            it.observed.program,
            number(it.observed.mean)
        );
        out.disc("ink", (scale.at(it.observed.mean), y), 4.0, &told);
        let name = match it.is_fitted {
            true => short(&it.observed.program, 26),
            false => format!("{} (held out)", short(&it.observed.program, 15)),
        };
        out.text_before("ink", (LEFT - 14.0, y + 4.0), &name);
    }
    out.line("axis", (LEFT, bottom), (RIGHT, bottom), "");
    let label = "mean time: measured (dot) and predicted (bar, 95 %)";
    out.text_around("ink", ((LEFT + RIGHT) / 2.0, bottom + 38.0), label);
}
