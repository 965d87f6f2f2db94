//! Columns of `runs.parquet`.
use stochc_ir::record::{FaultKind, Outcome, RunRecord};
use stochc_ir::table::PhaseId;

use super::column::TableDefinition;
use super::row::{RunRow, add_ticks, keyed, outcome};
use crate::manifest::SweepAxes;

/// Returns the phase that was running at the end of an incomplete run.
pub(super) fn unfinished(record: &RunRecord) -> Option<PhaseId> {
    match record.outcome {
        Outcome::Completed => None,
        Outcome::TimedOut { phase, .. } | Outcome::Failed { phase, .. } => Some(phase),
    }
}

pub(super) fn table<'a>(axes: &SweepAxes<'_>) -> TableDefinition<'a, RunRow<'a, ()>> {
    let mut table = keyed("runs", "a finished run", axes);
    table.text("assembly", "name of the assembly or aggregate", |row| {
        row.run.program.assembly()
    });
    table.text("scene", "name of the scene", |row| {
        row.run.program.scene.name.as_str()
    });
    table.text("outcome", "`completed`; `timed_out`: stopped by the timeout of a phase, so the run never completes; `censored`: stopped by \
             `--max-ticks`, so the time is a lower bound; `broken`: a bond of the structure broke, so the run never completes; `failed`: the computation failed", |row| outcome(&row.run.record.outcome));
    table
        .text(
            "failed_phase",
            "name of the phase that did not complete",
            |row| {
                let phase = unfinished(row.run.record)?;
                Some(row.run.program.phase(phase))
            },
        )
        .null("the run completed");
    table
        .integer(
            "failed_phase_number",
            "index of that phase, from 0",
            |row| unfinished(row.run.record).map(|phase| phase.0.into()),
        )
        .null("the run completed");
    table
        .text(
            "reason",
            "reason of the failure, or description of the broken bond",
            |row| match &row.run.record.outcome {
                Outcome::Failed { reason, .. } => Some(reason.as_str()),
                Outcome::Completed | Outcome::TimedOut { .. } => None,
            },
        )
        .null("the run neither failed nor broke");
    add_ticks(
        &mut table,
        "ticks",
        "time until the end of the run",
        |row| row.run.record.ticks,
    );
    table
        .real("tick_seconds", "length of a tick", |row| {
            row.run.program.scene.tick
        })
        .unit("s");
    table.texts(
        "phase_names",
        "names of all phases, by their index",
        |row| {
            let phases = row.run.program.phases().iter();
            phases.map(|phase| phase.name.as_str()).collect::<Vec<_>>()
        },
    );
    table.integers("phase_ticks", "durations of the completed phases, by their index; `phases.parquet` also has the other phases", |row| row.run.record.phase_ticks.as_slice()).unit("ticks");
    table.integer(
        "blocks_used",
        "number of different blocks that were captured; for an aggregate, blocks of the largest group",
        |row| u64::from(row.run.record.blocks_used),
    );
    table.integer(
        "captures",
        "number of captures: rows of `bonds.parquet` that are not censored",
        |row| row.run.record.all_bonds().count() as u64,
    );
    table.integer(
        "censored_captures",
        "number of faces still waiting at the end of the run or an attempt: rows of `bonds.parquet` that are censored",
        |row| row.run.record.all_waiting().count() as u64,
    );
    table.integer(
        "releases",
        "number of releases: rows of `releases.parquet`",
        |row| row.run.record.all_releases().count() as u64,
    );
    table.integer(
        "unplanned",
        "number of unplanned bonds: rows of `unplanned.parquet`",
        |row| row.run.record.unplanned_bonds.len() as u64,
    );
    table.integer("dead", "number of dockings of dead blocks", |row| {
        row.run.record.faults_of(FaultKind::Dead) as u64
    });
    table.integer("failed_latches", "dockings with a failed latch", |row| {
        row.run.record.faults_of(FaultKind::Latch) as u64
    });
    table.integer(
        "hops",
        "number of hops of messages between a block and its parent or child",
        |row| row.run.record.hops,
    );
    table.unsigned("seed", "seed of the ensemble", |row| row.run.manifest.seed);
    table
}
