//! Table of the captures of a program for a terminal.
use stochc_experiments::CaptureSummary;
use stochc_text::{Tick, percent};

use super::comparison::{in_ticks, mean, ticks};
use stochc_text::{TextColumn, TextTable, paragraph};

/// Returns a table of captures as plain text. `tick` is the length of a tick \[s\], and `width` the
/// width of the terminal \[characters\].
pub fn captures_to_text(captures: &[CaptureSummary], tick: f64, width: usize) -> String {
    let in_both_units = table(captures, Some(Tick(tick))).text(width, false);
    // A table that would be split has no seconds.
    let mut text = if in_both_units.contains("\n\n") {
        table(captures, None).text(width, false)
    } else {
        in_both_units
    };
    if is_censored(captures) {
        let note = "censored: waiting times that the end of a run cut short. The mean is then that of \
                    min(waiting time, horizon), a lower bound (≥).";
        text += &paragraph(note, width);
    }
    text
}

fn is_censored(captures: &[CaptureSummary]) -> bool {
    captures.iter().any(|capture| capture.wait.incomplete > 0)
}

/// Returns the table of the captures, with times in ticks. If `tick` is given, times are also in
/// seconds.
fn table(captures: &[CaptureSummary], tick: Option<Tick>) -> TextTable {
    const NONE: &str = "-";
    let seconds = |ticks: f64| tick.map_or(String::new(), |tick| tick.beside(ticks));
    let column = |header: &str, cell: &dyn Fn(&CaptureSummary) -> String| {
        TextColumn::figures(header, captures.iter().map(cell).collect())
    };
    let or_none = |text: Option<String>| text.unwrap_or(NONE.to_owned());
    let mut columns = vec![
        column("n", &|capture| capture.wait.completed.to_string()),
        column("waiting time", &|capture| match tick {
            Some(tick) => mean(Some(&capture.wait), tick),
            None => in_ticks(&capture.wait, ""),
        }),
        column("CV", &|capture| {
            or_none(capture.wait.cv.map(|cv| format!("{cv:.2}")))
        }),
        column("entries", &|capture| {
            or_none(capture.entries.map(|entries| format!("{entries:.1}")))
        }),
        column("docking", &|capture| {
            or_none(capture.docking.map(|it| ticks(it) + &seconds(it)))
        }),
    ];
    if captures.iter().any(|capture| !capture.released.is_empty()) {
        columns.push(column("released before", &released));
    }
    if is_censored(captures) {
        let cell = |capture: &CaptureSummary| capture.wait.incomplete.to_string();
        columns.insert(1, column("censored", &cell));
    }
    TextTable {
        labels: captures.iter().map(CaptureSummary::label).collect(),
        columns,
        ..TextTable::default()
    }
}

/// Returns each former role as text, with the share of captured blocks that had been released from
/// this role.
fn released(capture: &CaptureSummary) -> String {
    let share = |&(ref role, n): &(String, usize)| {
        let share = percent(n as f64 / capture.wait.completed as f64);
        format!("{role} {share}")
    };
    let shares: Vec<_> = capture.released.iter().map(share).collect();
    shares.join(", ")
}
