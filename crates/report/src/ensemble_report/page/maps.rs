//! Section with maps of the positions of blocks in recorded runs.
use stochc_files::shell;

use super::Parts;
use super::common::show;
use crate::analysis::maps::{AGES, Maps, Slice};
use crate::ensemble_report::html::{Html, code, name};
use crate::figures::{MapColumn, maps as picture};
use crate::svg::{Drawing, PlotAxis};

/// Adds the maps of a program, or instructions for making recordings. Adds nothing if blocks do not
/// move.
pub(super) fn maps(parts: &Parts, index: usize, out: &mut Html, drawings: &mut Vec<Drawing>) {
    /// Largest number of recordings that are listed one by one.
    const MAX_REASONS: usize = 3;
    let (subject, n) = (&parts.subjects[index], index + 1);
    let Some(maps) = &parts.maps[index] else {
        return;
    };
    out.heading(3, &format!("maps-of-{n}"), "Positions of blocks");
    let mut warn = |text: String| out.raw(&format!("<p class=\"warn\">{text}</p>\n"));
    for (run, reason) in maps.left_out.iter().take(MAX_REASONS) {
        let reason = name(reason);
        warn(format!("The recording of run {run} is left out: {reason}."));
    }
    if maps.left_out.len() > MAX_REASONS {
        let rest = maps.left_out.len() - MAX_REASONS;
        warn(format!("{rest} more recordings are left out."));
    }
    if maps.runs == 0 {
        let folder = shell::file(&parts.inputs[subject.folder].path);
        let line = format!("stochc repeat {folder} --record all --out AGAIN");
        out.note(&format!(
            "There are no maps, because no run has a readable recording. This command repeats the runs and records them: {}",
            code(&line)
        ));
        return;
    }
    let runs = match maps.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    out.note(&format!(
        "These maps use {runs} with a recording. Lighter places have larger values, and blank places have none. A dot marks a \
         value whose 95 % confidence interval (bootstrap over runs) is wider than twice the value. Cells of the structure \
         are outlined."
    ));
    before(parts, n, maps, out, drawings);
    near(parts, n, maps, out, drawings);
}

fn before(parts: &Parts, n: usize, maps: &Maps, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let label = &parts.subjects[n - 1].label;
    let program = &parts.subjects[n - 1];
    let title = format!("{label}: where captured blocks were before");
    let columns: Vec<MapColumn> = (AGES.iter().zip(&maps.before))
        .map(|(age, slices)| MapColumn {
            title: format!("{} before", program.described(*age as f64)),
            maps: slices.iter().collect(),
            shows: PlotAxis::new("part of the captures", "% per cubic block length"),
            unit: 100.0,
        })
        .collect();
    let description = "Blocks around the cell of a capture, at three times before the capture, in two slices each.";
    let file = format!("before-{n}");
    let figure = |medium| picture(medium, &file, (&title, description), &columns);
    let caption = "The cell of the capture is at 0. The upper row shows a horizontal slice, two block lengths thick, and the lower row \
                   a vertical one. Blocks that were part of the structure at that time are left out.";
    show(parts, out, drawings, figure, caption, &["maps.csv"]);
}

fn near(parts: &Parts, n: usize, maps: &Maps, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let label = &parts.subjects[n - 1].label;
    let occupation = PlotAxis::new("free blocks in a cell", "number");
    let (interval, ticks) = parts.subjects[n - 1].rate_interval();
    let entries = PlotAxis::new("entries at open faces", &format!("number per {interval}"));
    let kinds = [
        ("Free blocks", &maps.occupation, occupation, 1.0),
        ("Entries", &maps.entries, entries, ticks),
    ];
    let columns = kinds
        .into_iter()
        .filter_map(|(title, slices, shows, unit)| {
            Some(MapColumn {
                title: title.to_owned(),
                maps: slices.as_ref()?.iter().collect(),
                shows,
                unit,
            })
        });
    let columns: Vec<MapColumn> = columns.collect();
    let title = format!("{label}: free blocks near the structure");
    let description = "Mean number of free blocks in each cell. Cells that open faces fill show how often blocks enter the reach of \
                the face.";
    let file = format!("near-{n}");
    let figure = |medium| picture(medium, &file, (&title, description), &columns);
    let slices = maps.occupation.iter().flatten().map(|map| match map.slice {
        Slice::Horizontal(z) => format!("layer {z} (above)"),
        Slice::Vertical(y) => format!("the plane {y} north (below)"),
    });
    let slices: Vec<String> = slices.collect();
    let caption = format!(
        "The maps show the cells of two slices with most of the captures: {}.",
        slices.join(" and ")
    );
    let data = ["maps.csv", "faces.csv"];
    show(parts, out, drawings, figure, &caption, &data);
}
