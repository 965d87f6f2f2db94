//! Figure of mean times over a scene parameter.
use stochc_experiments::Time;
use stochc_experiments::sweep::SweepPoint;
use stochc_text::number;

use super::frame::{AxesFrame, DECADE, Panel, YScale, aside, description};
use crate::svg::{Drawing, PlotAxis, Style, class, dashes};

/// Draws means with their 95 % intervals, and medians. Returns `None` if no run has a time.
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
    let is_bound = times().any(|time| time.incomplete > 0);
    let is_absent = panel.points.iter().any(|point| point.time.is_none());
    let mut notes = vec!["dots: means, lines: their 95 % intervals, short bars: medians"];
    if is_bound {
        notes.push("hollow with ≥: some runs were stopped before they completed, the mean is at least this");
    }
    if is_absent {
        notes.push("×: no run has a time");
    }
    let of = &panel.sweep.axes[0].name;
    let title = format!("Mean completion time over {of}");
    let words = description(&curves, |point| described(point, unit));
    let axis = PlotAxis::new("mean completion time", unit);
    let AxesFrame {
        mut out,
        x,
        y,
        bottom,
    } = panel.frame(
        &panel.name,
        (&title, &words),
        &curves,
        (&axis, scale(&panel.points, last)),
        (&notes, number),
    );
    for (i, curve) in curves.iter().enumerate() {
        let position = |value: f64| x.at(value) + aside(i, curves.len());
        let mean = |(value, point): &(f64, &SweepPoint)| {
            let time = point.time.as_ref()?;
            Some((position(*value), y.at(time.mean)))
        };
        let path: Vec<_> = curve.points.iter().filter_map(mean).collect();
        out.curve(class(i), &path, dashes(i));
        for (value, point) in &curve.points {
            let (at, tooltip) = (
                position(*value),
                format!("{}: {}", point.name, described(point, unit)),
            );
            let Some(time) = &point.time else {
                out.text_around("ink", (at, bottom - 3.0), "×");
                continue;
            };
            let ends = [time.mean - half(time), time.mean + half(time)].map(|end| y.at(end));
            out.stroke(class(i), (at, ends[0]), (at, ends[1]), Style::line(2.0));
            if let Some(median) = time.median.map(|median| y.at(median)) {
                let (from, to) = ((at - 7.0, median), (at + 7.0, median));
                out.stroke(class(i), from, to, Style::line(2.0));
            }
            let mean = (at, y.at(time.mean));
            out.disc(class(i), mean, 4.5, &tooltip);
            if time.incomplete > 0 {
                out.disc("paper", mean, 2.6, &tooltip);
                out.text("ink", (at + 8.0, mean.1 - 6.0), "≥");
            }
        }
    }
    Some(out)
}

/// Returns the scale of times. It is logarithmic if both the parameter and the times span more than
/// a factor of ten. A power law is then a straight line. Otherwise, the scale is linear and begins
/// at 0.
fn scale(points: &[&SweepPoint], last: f64) -> YScale {
    let spans = |values: &mut dyn Iterator<Item = f64>| {
        let (least, most) = values.fold((f64::INFINITY, 0.0_f64), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        least > 0.0 && most / least > DECADE
    };
    let mut numbers = points
        .iter()
        .filter_map(|it| Some(it.values.first()?.value));
    let times = || points.iter().filter_map(|it| it.time.as_ref());
    let means = || times().map(|time| time.mean).filter(|mean| *mean > 0.0);
    if !spans(&mut numbers) || !spans(&mut means()) {
        // Add space for a mark above the highest dot.
        return YScale::Linear(0.0, 1.06 * last);
    }
    // The lower end of an interval can be 0, which a logarithmic axis cannot show. Draw it to the
    // edge.
    let least = means().fold(f64::INFINITY, f64::min);
    let ends = times().flat_map(|time| {
        [
            time.mean - time.half_width.unwrap_or(0.0),
            time.median.unwrap_or(least),
        ]
    });
    let low = ends.filter(|end| *end > 0.3 * least).fold(least, f64::min);
    YScale::Logarithmic(0.9 * low, 1.15 * last)
}

pub(super) fn described(point: &SweepPoint, unit: &str) -> String {
    let Some(time) = &point.time else {
        return "no time".to_owned();
    };
    let bound = if time.incomplete > 0 { "≥ " } else { "" };
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
