//! All figures of a sweep.
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptValue};

use super::frame::Panel;
use super::{heat, share, times};
use crate::svg::{Drawing, Medium};

/// Largest number of curves in one figure. More become a heat map.
const CURVES: usize = 6;

/// Largest number of figures for the values of the third and further parameters. The table shows
/// larger sweeps.
const PANELS: usize = 6;

/// Draws mean times and shares of completed runs. `prefix` begins the names of their files.
///
/// The first parameter is the horizontal axis. Each combination of settings counts as a program.
/// Each value of the second parameter has its curve, or its row in a map. Each combination of
/// further values has its own figures, unless there are too many.
pub fn pictures(medium: Medium, sweep: &Sweep, prefix: &str) -> Vec<Drawing> {
    // Settings have no axis.
    if sweep.axes.is_empty() {
        return Vec::new();
    }
    let mut further: Vec<&[SweptValue]> = Vec::new();
    for point in &sweep.points {
        let rest = point.values.get(2..).unwrap_or_default();
        if !further.contains(&rest) {
            further.push(rest);
        }
    }
    if further.len() > PANELS {
        return Vec::new();
    }
    let mut drawings = Vec::new();
    for (i, &rest) in further.iter().enumerate() {
        let here = |point: &&SweepPoint| point.values.get(2..).unwrap_or_default() == rest;
        let panel = Panel {
            medium,
            sweep,
            points: sweep.points.iter().filter(here).collect(),
            name: match further.len() {
                1 => prefix.to_owned(),
                _ => format!("{prefix}-{}", i + 1),
            },
            rest,
        };
        let is_map = sweep.axes.len() > 1 && panel.curves().len() > CURVES;
        if is_map {
            let programs = sweep.programs();
            let maps = programs.iter().enumerate();
            drawings.extend(maps.filter_map(|(k, program)| {
                let name = match programs.len() {
                    1 => panel.name.clone(),
                    _ => format!("{}-map-{}", panel.name, k + 1),
                };
                heat::heat(&panel, &name, program)
            }));
        } else {
            drawings.extend(times::times(&panel));
            drawings.extend(share::share(&panel));
        }
    }
    drawings
}
