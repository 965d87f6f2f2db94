//! `phases.parquet`.
use stochc_ir::table::PhaseId;

use super::column::{ColumnDefinition, TableDefinition, integer, real, text};
use super::row::{RunContext, RunRow, key, outcome, phase};
use crate::manifest::SweepAxes;

/// A phase that a run has reached.
pub(super) struct Reached {
    phase: PhaseId,
    began: u64,
    /// `None`: it was under way when the run ended.
    ended: Option<u64>,
}

impl Reached {
    /// Returns how long it took, or had taken when the run ended.
    fn ticks(&self, run: RunContext<'_>) -> u64 {
        let end = self.ended.unwrap_or(run.record.ticks);
        end.saturating_sub(self.began)
    }
}

/// The phases that a run has reached, in their order.
pub(super) fn reached(run: RunContext) -> Vec<Reached> {
    let mut began = 0u64;
    let mut phases = Vec::new();
    let all = 0..run.program.phases().len() as u32;
    for (number, ticks) in all.clone().zip(&run.record.phase_ticks) {
        // A journal may have been edited.
        let end = began.saturating_add(*ticks);
        phases.push(Reached {
            phase: PhaseId(number),
            began,
            ended: Some(end),
        });
        began = end;
    }
    let next = run.record.phase_ticks.len() as u32;
    if super::runs::unfinished(run.record) == Some(PhaseId(next)) && all.contains(&next) {
        phases.push(Reached {
            phase: PhaseId(next),
            began,
            ended: None,
        });
    }
    phases
}

pub(super) fn table<'a>(axes: &SweepAxes<'_>) -> TableDefinition<'a, RunRow<'a, Reached>> {
    type R<'a> = RunRow<'a, Reached>;
    let mut columns = key(axes);
    columns.extend(phase(|reached: &Reached| reached.phase));
    columns.extend([
        ColumnDefinition::new(
            "outcome",
            "",
            "`completed`, or that of the run, which ended in this phase: `timed_out`, `censored` \
             or `failed` (it means nothing)",
            text(|row: &R<'a>| match row.of.ended {
                Some(_) => "completed",
                None => outcome(&row.run.record.outcome),
            }),
        ),
        ColumnDefinition::new(
            "began",
            "ticks",
            "when it began, from the beginning of the run",
            integer(|row: &R<'a>| row.of.began),
        ),
        ColumnDefinition::new(
            "ended",
            "ticks",
            "when it was complete",
            integer(|row: &R<'a>| row.of.ended),
        )
        .null("the run ended before"),
        ColumnDefinition::new(
            "ticks",
            "ticks",
            "how long it took, or had taken when the run ended",
            integer(|row: &R<'a>| row.of.ticks(row.run)),
        ),
        ColumnDefinition::new(
            "seconds",
            "s",
            "the same in seconds of the scene",
            real(|row: &R<'a>| row.run.seconds(row.of.ticks(row.run))),
        ),
    ]);
    TableDefinition {
        name: "phases",
        row: "a phase that a run has reached",
        columns,
    }
}
