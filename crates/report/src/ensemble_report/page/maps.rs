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
            "There is no map, because no run of it has a recording here that can be read: {} makes the same \
             runs with one each.",
            code(&line)
        ));
        return;
    }
    let runs = match maps.runs {
        1 => "1 run".to_owned(),
        runs => format!("{runs} runs"),
    };
    out.note(&format!(
        "Of {runs} with a recording. The lighter a place, the more; what is blank was never seen. A dot says that the 95 % \
         interval, by a bootstrap over runs, is longer than twice the value. Outlined are places of the structure."
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
            shows: PlotAxis::new("part of the captures", "% per cubic side"),
            unit: 100.0,
        })
        .collect();
    let description = "Two slices for each of three times before a capture, around the cell in which the block \
                then sits.";
    let file = format!("before-{n}");
    let figure = |medium| picture(medium, &file, (&title, description), &columns);
    let caption = "Around the cell of their capture, which is at 0: above in a horizontal slice of two \
                   sides, below in a vertical one. Blocks that were part of the structure then are left out.";
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
    let description = "Free blocks in each cell on average over time, and how often blocks enter the reach of a \
                face that waits, at the cell that it fills.";
    let file = format!("near-{n}");
    let figure = |medium| picture(medium, &file, (&title, description), &columns);
    let slices = maps.occupation.iter().flatten().map(|map| match map.slice {
        Slice::Horizontal(z) => format!("layer {z} (above)"),
        Slice::Vertical(y) => format!("the plane {y} north (below)"),
    });
    let slices: Vec<String> = slices.collect();
    let caption = format!(
        "Places are cells of the program: {}, which have most of the captures.",
        slices.join(" and ")
    );
    let data = ["maps.csv", "faces.csv"];
    show(parts, out, drawings, figure, &caption, &data);
}
