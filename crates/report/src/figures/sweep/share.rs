//! Figure of the share of completed runs over a scene parameter.
use stochc_experiments::sweep::SweepPoint;
use stochc_text::percent_number;

use super::frame::{AxesFrame, Panel, YScale, aside, description};
use crate::svg::{Drawing, PlotAxis, Style, class, dashes};

/// Draws shares with their 95 % intervals. Returns `None` if no run is finished.
pub(super) fn share(panel: &Panel) -> Option<Drawing> {
    let curves = panel.curves();
    panel.points.iter().find(|point| point.share.is_some())?;
    let of = &panel.sweep.axes[0].name;
    let title = format!("Share of completed runs over {of}");
    let words = description(&curves, described);
    let name = format!("{}-completed", panel.name);
    let notes = ["dots: the part of the finished runs that completed, lines: 95 % intervals"];
    let axis = PlotAxis::new("runs that completed", "%");
    let AxesFrame { mut out, x, y, .. } = panel.frame(
        &name,
        (&title, &words),
        &curves,
        (&axis, YScale::Linear(0.0, 1.0)),
        (&notes, percent_number),
    );
    for (i, curve) in curves.iter().enumerate() {
        let position = |value: f64| x.at(value) + aside(i, curves.len());
        let known = (curve.points.iter())
            .filter_map(|(value, point)| Some((position(*value), point.share?, point)));
        let known: Vec<_> = known.collect();
        let path: Vec<_> = known
            .iter()
            .map(|(at, share, _)| (*at, y.at(*share)))
            .collect();
        out.curve(class(i), &path, dashes(i));
        for (at, share, point) in known {
            if let Some((low, high)) = point.share_interval {
                out.stroke(
                    class(i),
                    (at, y.at(low)),
                    (at, y.at(high)),
                    Style::line(2.0),
                );
            }
            let tooltip = format!("{}: {}", point.name, described(point));
            out.disc(class(i), (at, y.at(share)), 4.5, &tooltip);
        }
    }
    Some(out)
}

fn described(point: &SweepPoint) -> String {
    format!("{} of {} completed", point.completed, point.finished())
}
