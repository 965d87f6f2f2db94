//! Estimates as text.
use stochc_ensemble::text::percent;

use super::rates::KNOWN_BIAS;
use crate::estimate::{Estimate, Times};
use crate::text::{TextColumn, TextTable, paragraph};

/// The times of programs and of their phases, and the `most` events of each that decide most of them; `width` is that of the
/// terminal, in characters.
pub fn estimates_to_text(estimates: &[Estimate], most: usize, width: usize) -> String {
    let mut text = String::new();
    for (number, estimate) in estimates.iter().enumerate() {
        if number > 0 {
            text.push('\n');
        }
        text += &times(estimate).text(width, false);
        if estimate.stopped > 0 {
            text += &format!(
                "{} of {} runs did not complete, and count for nothing here\n",
                estimate.stopped,
                estimate.stopped + estimate.completed
            );
        }
        if most > 0 && !estimate.shares.is_empty() {
            text += &format!("\n{}", shares(estimate, most).text(width, false));
        }
    }
    text + "\n" + &paragraph(KNOWN_BIAS, width)
}

fn times(estimate: &Estimate) -> TextTable {
    let total = std::iter::once((format!("{}, ticks", estimate.program), estimate.total));
    // A program of one phase is that phase.
    let phases = estimate.phases.iter().filter(|_| estimate.phases.len() > 1);
    let phases = phases.map(|phase| (format!("  {}", phase.name), phase.times));
    let rows: Vec<(String, Option<Times>)> = total.chain(phases).collect();
    let column = |header: &str, value: &dyn Fn(&Times) -> String| {
        let cell = |times: &Option<Times>| times.as_ref().map_or("?".to_owned(), value);
        TextColumn::figures(header, rows.iter().map(|(_, times)| cell(times)).collect())
    };
    TextTable {
        label: "by rates".to_owned(),
        columns: vec![
            column("mean", &|it| {
                format!("{:.0} ± {:.0}", it.mean, it.half_width)
            }),
            column("10 %", &|it| format!("{:.0}", it.p10)),
            column("median", &|it| format!("{:.0}", it.median)),
            column("90 %", &|it| format!("{:.0}", it.p90)),
        ],
        labels: rows.iter().map(|(name, _)| name.clone()).collect(),
        ..TextTable::default()
    }
}

fn shares(estimate: &Estimate, most: usize) -> TextTable {
    let shown = &estimate.shares[..most.min(estimate.shares.len())];
    TextTable {
        label: "waited for, and for nothing else".to_owned(),
        labels: shown.iter().map(|share| share.event.clone()).collect(),
        columns: vec![TextColumn::figures(
            "of the time",
            shown.iter().map(|share| percent(share.share)).collect(),
        )],
        ..TextTable::default()
    }
}
