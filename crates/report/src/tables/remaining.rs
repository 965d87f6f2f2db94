//! Table of the remaining times of runs in progress.
use stochc_text::{TextColumn, TextTable, number, paragraph};

use super::estimate::lower_bound;
use super::rates::{KNOWN_BIAS, first_guess};
use crate::estimate::RemainingEstimate;

/// Returns a table of remaining times. `width` is the width of the terminal \[characters\].
pub fn remaining_to_text(runs: &[RemainingEstimate], width: usize) -> String {
    if runs.is_empty() {
        return "No run is in progress: all runs have ended.\n".to_owned();
    }
    let column = |header: &str, cell: &dyn Fn(&RemainingEstimate) -> String| {
        TextColumn::figures(header, runs.iter().map(cell).collect())
    };
    let or_unknown = |ticks: Option<f64>| ticks.map_or("?".to_owned(), |it| number(it.round()));
    let table = TextTable {
        label: "run in progress".to_owned(),
        labels: (runs.iter())
            .map(|it| format!("{}, run {}", it.program, it.run))
            .collect(),
        columns: vec![
            column("events", &|it| format!("{} of {}", it.happened, it.events)),
            column("elapsed", &|it| number(it.elapsed as f64)),
            column("remaining", &|it| {
                or_unknown(it.remaining.and_then(|it| it.median))
            }),
            column("90 % interval", &|it| {
                let ends = it.remaining.map_or([None; 2], |it| [it.low, it.high]);
                ends.map(or_unknown).join(" .. ")
            }),
        ],
        ..TextTable::default()
    };
    let mut text = table.text(width, false) + "\n";
    text += &paragraph(
        "Times are in ticks. The remaining time is the median of samples that continue from the events so far.",
        width,
    );
    if runs
        .iter()
        .any(|it| it.remaining.is_none_or(|it| it.timed_out > 0.0))
    {
        text += &paragraph(
            "? is unknown, because samples reach a timeout, or because no free block is left.",
            width,
        );
    }
    for run in runs {
        let bound = lower_bound(run.lower_bound, width);
        if !text.contains(&bound) {
            text += &bound;
        }
    }
    text.push('\n');
    if runs.iter().any(|it| it.is_first_guess) {
        text += &paragraph(&first_guess(), width);
    }
    if runs.iter().any(|it| !it.is_first_guess) {
        text += &paragraph(KNOWN_BIAS, width);
    }
    text
}
