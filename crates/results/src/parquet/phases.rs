//! Columns of `phases.parquet`.
use stochc_ir::table::PhaseId;

use super::column::TableDefinition;
use super::row::{RunContext, RunRow, add_phase, add_ticks, keyed, outcome};
use crate::manifest::SweepAxes;

/// Phase that a run has reached.
pub(super) struct Reached {
    phase: PhaseId,
    began: u64,
    /// Tick of the phase's end. `None` if the phase was running at the end of the run.
    ended: Option<u64>,
}

impl Reached {
    /// Returns the duration of the phase \[ticks\]. An unfinished phase lasts until the end of the
    /// run.
    fn ticks(&self, run: RunContext<'_>) -> u64 {
        let end = self.ended.unwrap_or(run.record.ticks);
        end.saturating_sub(self.began)
    }
}

/// Returns the phases reached by a run, in order.
pub(super) fn reached(run: RunContext) -> Vec<Reached> {
    let mut began = 0u64;
    let mut phases = Vec::new();
    let all = 0..run.program.phases().len() as u32;
    for (number, ticks) in all.clone().zip(&run.record.phase_ticks) {
        // The journal may have been edited, so avoid overflow.
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
    let mut table = keyed("phases", "a phase that a run has reached", axes);
    add_phase(&mut table, |of: &Reached| of.phase);
    table.text(
        "outcome",
        "`completed`; or the outcome of the run, if it ended in this phase: `timed_out`, `censored`, \
             `broken` or `failed`",
        |row| match row.item.ended {
            Some(_) => "completed",
            None => outcome(&row.run.record.outcome),
        },
    );
    table
        .integer(
            "began",
            "start of the phase, from the start of the run",
            |row| row.item.began,
        )
        .unit("ticks");
    table
        .integer(
            "ended",
            "end of the phase, from the start of the run",
            |row| row.item.ended,
        )
        .unit("ticks")
        .null("the run ended earlier");
    table.integer(
        "retries",
        "number of times that the phase was begun again after a timeout",
        |row| row.run.record.retries(row.item.phase),
    );
    add_ticks(
        &mut table,
        "ticks",
        "duration of the phase; if the run ended in this phase, duration until then",
        |row| row.item.ticks(row.run),
    );
    table
}
