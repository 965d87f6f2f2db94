//! Table of a sweep for a terminal, with a row for each point.
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptElasticity};
use stochc_text::{number, percent};

use super::comparison::{LOWER_BOUND, NEVER_COMPLETES, UNFINISHED, mean, ticks};
use super::optimum::estimate_to_text;
use super::published;
use stochc_text::{TextColumn, TextTable, paragraph};

/// Text of a cell whose value is unknown.
const NONE: &str = "-";

/// Returns the table of a sweep, with notes about its values. `width` is the width of the terminal
/// \[characters\].
pub fn sweep_to_text(sweep: &Sweep, width: usize) -> String {
    let mut text = sweep_rows(sweep, true).text(width, false);
    text.push('\n');
    if has_elasticities(sweep) {
        text += &format!("{}\n", elasticities(sweep).text(width, false));
    }
    for note in notes(sweep) {
        text += &paragraph(&note, width);
    }
    text
}

/// Returns the table of a sweep's points, in the unit of the sweep. `with_seconds` adds seconds
/// after ticks.
pub(super) fn sweep_rows(sweep: &Sweep, with_seconds: bool) -> TextTable {
    let tick = |point: &SweepPoint| sweep.tick(point).filter(|_| with_seconds);
    let time = |point: &SweepPoint, value: f64| match tick(point) {
        Some(tick) => ticks(value) + &tick.beside(value),
        None => number(value),
    };
    let column = |header: &str, cell: &dyn Fn(&SweepPoint) -> String| {
        TextColumn::figures(header, sweep.points.iter().map(cell).collect())
    };
    let maybe = |value: Option<String>| value.unwrap_or(NONE.to_owned());
    let share = |share: Option<f64>| maybe(share.map(percent));
    let mut columns = vec![
        column("completed", &|point| {
            format!("{} of {}", point.completed, point.finished())
        }),
        column("mean time", &|point| match tick(point) {
            None => maybe(point.time.as_ref().map(published::mean)),
            Some(tick) => mean(point.time.as_ref(), tick),
        }),
        column("median", &|point| {
            let median = point.time.as_ref().and_then(|it| it.median);
            maybe(median.map(|median| time(point, median)))
        }),
        column("per capture", &|point| {
            maybe(point.time_per_capture.map(|it| time(point, it)))
        }),
    ];
    if sweep.points.iter().any(|point| point.released > Some(0.0)) {
        columns.push(column("released", &|point| share(point.released)));
    }
    if sweep.points.iter().any(|point| point.failed > 0) {
        let failed = column("failed", &|point| point.failed.to_string());
        columns.insert(1, failed);
    }
    TextTable {
        labels: sweep
            .points
            .iter()
            .map(|point| point.name.clone())
            .collect(),
        columns,
        ..TextTable::default()
    }
}

fn has_elasticities(sweep: &Sweep) -> bool {
    sweep.elasticities.iter().any(|it| it.elasticity.is_some())
}

/// Returns a table with a row for each program and parameter.
fn elasticities(sweep: &Sweep) -> TextTable {
    let column = |header: &str, cell: &dyn Fn(&SweptElasticity) -> String| {
        TextColumn::figures(header, sweep.elasticities.iter().map(cell).collect())
    };
    TextTable {
        labels: (sweep.elasticities.iter())
            .map(|it| format!("{}: {}", it.program, it.parameter))
            .collect(),
        columns: vec![
            column("elasticity", &|it| estimate_to_text(it.elasticity.as_ref())),
            column("points", &|it| it.points.to_string()),
        ],
        ..TextTable::default()
    }
}

fn notes(sweep: &Sweep) -> Vec<String> {
    let mut notes = vec![format!(
        "Times are in {}. ± is the 95 % confidence interval of the mean. Per capture: the time of all runs, divided by their \
         number of captures.",
        match sweep.unit {
            "s" => "seconds, because the points differ in the length of a tick",
            _ => "ticks, with seconds in brackets",
        }
    )];
    let points = || sweep.points.iter();
    if points().any(|point| point.released > Some(0.0)) {
        let note = "Released: the share of captures that bonded a released block.";
        notes.push(note.to_owned());
    }
    if points().any(|point| (point.finished() as u64) < point.runs) {
        notes.push(UNFINISHED.to_owned());
    }
    if points().any(|point| point.timed_out + point.censored > 0) {
        notes.push(LOWER_BOUND.to_owned());
    }
    if points().any(|point| point.timed_out > 0) {
        notes.push(NEVER_COMPLETES.to_owned());
    }
    if has_elasticities(sweep) {
        let note = "Elasticity: the relative change of the mean time, divided by the relative change of the parameter. It is \
                    the slope of the logarithms at these points, with its 95 % interval. Points with incomplete runs or fewer than \
                    10 runs are left out.";
        notes.push(note.to_owned());
    }
    notes
}
