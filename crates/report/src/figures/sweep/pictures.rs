//! Selection of all figures of a sweep.
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptValue};

use super::frame::Panel;
use super::{heat, share, times};
use crate::svg::{Drawing, Medium};

/// Largest number of curves in one figure. A heat map replaces a larger number of curves.
const CURVES: usize = 6;

/// Largest number of figures for different values of the third and later scene parameters. For
/// larger sweeps, there is only the table.
const PANELS: usize = 6;

/// Draws mean times and shares of completed runs. The names of the files begin with `prefix`.
///
/// The horizontal axis is the first scene parameter. Each combination of settings counts as a
/// program. Each value of the second parameter has its own curve, or its own row in a heat map.
/// Each combination of later parameters has its own figures, unless there are too many.
pub fn pictures(medium: Medium, sweep: &Sweep, prefix: &str) -> Vec<Drawing> {
    // A sweep over settings only has no axis.
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
