//! Mean times over a number that was varied.
use stochc_ensemble::Time;
use stochc_ensemble::sweep::SweepPoint;
use stochc_ensemble::text::number;

use super::frame::{BOTTOM, LEFT, Panel, RIGHT, TOP, aside, told};
use crate::svg::{DASHES, Drawing, Scale, class};

/// Means with their 95 % intervals, and medians; `None`: no run has a time.
pub(super) fn times(panel: &Panel) -> Option<Drawing> {
    let curves = panel.curves();
    let unit = panel.sweep.unit;
    let times = || panel.points.iter().filter_map(|point| point.time.as_ref());
    let half = |time: &Time| time.half_width.unwrap_or(0.0);
    let ends = times().flat_map(|time| [time.mean + half(time), time.median.unwrap_or(0.0)]);
    let last = ends.fold(0.0, f64::max);
    if last <= 0.0 {
        return None;
    }
    let is_bound = times().any(|time| time.censored > 0);
    let is_absent = panel.points.iter().any(|point| point.time.is_none());
    let mut notes = vec!["dots: means, lines: their 95 % intervals, short bars: medians"];
    if is_bound {
        notes.push("hollow with ≥: some runs were stopped before they completed, the mean is at least this");
    }
    if is_absent {
        notes.push("×: no run has a time");
    }
    let of = &panel.sweep.axes[0].of;
    let title = format!("Mean time to completion over {of}");
    let words = told(&curves, |point| described(point, unit));
    let (mut out, x) = panel.drawing(&panel.name, &title, &words, &curves, &notes);
    // Room for a sign above the highest dot.
    let y = Scale::linear((0.0, 1.06 * last), (BOTTOM, TOP));
    let axis = format!("mean time to completion [{unit}]");
    out.upward(&y, (BOTTOM, TOP), LEFT, RIGHT, &axis, number);
    for (i, curve) in curves.iter().enumerate() {
        let place = |value: f64| x.at(value) + aside(i, curves.len());
        let mean = |(value, point): &(f64, &SweepPoint)| {
            let time = point.time.as_ref()?;
            Some((place(*value), y.at(time.mean)))
        };
        let places: Vec<_> = curve.points.iter().filter_map(mean).collect();
        out.curve(class(i), &places, DASHES[i % DASHES.len()]);
        for (value, point) in &curve.points {
            let (at, told) = (
                place(*value),
                format!("{}: {}", point.name, described(point, unit)),
            );
            let Some(time) = &point.time else {
                out.text_around("ink", (at, BOTTOM - 3.0), "×");
                continue;
            };
            let ends = [time.mean - half(time), time.mean + half(time)].map(|end| y.at(end));
            out.line(class(i), (at, ends[0]), (at, ends[1]), "stroke-width=\"2\"");
            if let Some(median) = time.median.map(|median| y.at(median)) {
                let more = "stroke-width=\"2\"";
                out.line(class(i), (at - 7.0, median), (at + 7.0, median), more);
            }
            let mean = (at, y.at(time.mean));
            out.disc(class(i), mean, 4.5, &told);
            if time.censored > 0 {
                out.disc("paper", mean, 2.6, &told);
                out.text("ink", (at + 8.0, mean.1 - 6.0), "≥");
            }
        }
    }
    Some(out)
}

pub(super) fn described(point: &SweepPoint, unit: &str) -> String {
    let Some(time) = &point.time else {
        return "no time".to_owned();
    };
    let bound = if time.censored > 0 { "at least " } else { "" };
    let half = time.half_width.map(|half| format!(" ± {}", number(half)));
    let median = match time.median {
        Some(median) => format!(", median {}", number(median)),
        None => ", no median".to_owned(),
    };
    format!(
        "{bound}{}{} {unit}{median}, {} of {} completed",
        number(time.mean),
        half.unwrap_or_default(),
        point.completed,
        point.finished()
    )
}
