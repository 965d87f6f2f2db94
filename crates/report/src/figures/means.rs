//! Figure of mean completion times.
use stochc_experiments::Time;
use stochc_text::number;

use super::EDGE;
use crate::svg::letters::{fitted, widest};
use crate::svg::{Drawing, Medium, PlotAxis, Scale, Style, class};

/// Draws the mean time of each program as a dot, with its 95 % interval.
pub(crate) fn means(medium: Medium, times: &[(&str, Time)], unit: &str) -> Option<Drawing> {
    const TOP: f64 = 14.0;
    const ROW: f64 = 26.0;
    let half = |time: &Time| time.half_width.unwrap_or(0.0);
    let ends = times.iter().map(|(_, time)| time.mean + half(time));
    let last = ends.fold(0.0, f64::max);
    if last <= 0.0 {
        return None;
    }
    let tooltip: Vec<_> = times
        .iter()
        .map(|(name, time)| described(name, time, unit))
        .collect();
    let bottom = TOP + ROW * times.len() as f64;
    let description = format!("{}.", tooltip.join(". "));
    let title = "Mean completion times";
    let mut out = Drawing::new(medium, "means", title, &description);
    let names = widest(times.iter().map(|(name, _)| *name)).min(0.34 * medium.width());
    let (left, right) = (EDGE + names + 12.0, medium.width() - 24.0);
    let x = Scale::linear((0.0, last), (left, right));
    let of = PlotAxis::new("mean completion time, 95\u{a0}% interval", unit);
    let end = out.across(&x, (left, right), bottom, TOP, &of);
    for (i, ((name, time), tooltip)) in times.iter().zip(&tooltip).enumerate() {
        let y = TOP + ROW * (i as f64 + 0.5);
        out.text("ink", (EDGE, y + 4.0), &fitted(name, names));
        let (low, high) = (x.at(time.mean - half(time)), x.at(time.mean + half(time)));
        out.stroke(class(i), (low, y), (high, y), Style::line(3.0));
        out.disc(class(i), (x.at(time.mean), y), 5.0, tooltip);
        if time.incomplete > 0 {
            out.text("ink", (high + 7.0, y + 4.0), "≥");
        }
    }
    Some(out.high(end - 10.0))
}

fn described(name: &str, time: &Time, unit: &str) -> String {
    let bound = if time.incomplete > 0 { "≥ " } else { "" };
    let half = match time.half_width {
        Some(half) => format!(" ± {}", number(half)),
        None => String::new(),
    };
    format!("{name}: {bound}{}{half} {unit}", number(time.mean))
}
