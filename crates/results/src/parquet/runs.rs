//! Columns of `runs.parquet`.
use stochc_ir::record::{Outcome, RunRecord};
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
    table.text("outcome", "`completed`; `timed_out`: stopped by the timeout of a phase, its time is infinite; `censored`: stopped by \
             `--max-ticks`, its time is longer; `failed`: the physics broke down, its time means nothing", |row| outcome(&row.run.record.outcome));
    table
        .text(
            "failed_phase",
            "name of the phase that was stopped or failed",
            |row| {
                let phase = unfinished(row.run.record)?;
                Some(row.run.program.phase(phase))
            },
        )
        .null("it completed");
    table
        .integer(
            "failed_phase_number",
            "index of that phase, from 0",
            |row| unfinished(row.run.record).map(|phase| phase.0.into()),
        )
        .null("it completed");
    table
        .text("reason", "why it failed", |row| {
            match &row.run.record.outcome {
                Outcome::Failed { reason, .. } => Some(reason.as_str()),
                Outcome::Completed | Outcome::TimedOut { .. } => None,
            }
        })
        .null("it did not fail");
    add_ticks(&mut table, "ticks", "time until its end", |row| {
        row.run.record.ticks
    });
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
    table.integers("phase_ticks", "time that each phase took which was completed, by its index; `phases.parquet` has the others as well", |row| row.run.record.phase_ticks.as_slice()).unit("ticks");
    table.integer(
        "blocks_used",
        "different blocks that were captured; of an aggregate, blocks of the largest group",
        |row| u64::from(row.run.record.blocks_used),
    );
    table.integer(
        "captures",
        "rows of `bonds.parquet` that are not censored",
        |row| row.run.record.bonds.len() as u64,
    );
    table.integer(
        "under_way",
        "rows of `bonds.parquet` that are censored",
        |row| row.run.record.waiting.len() as u64,
    );
    table.integer("releases", "rows of `releases.parquet`", |row| {
        row.run.record.releases.len() as u64
    });
    table.integer("unplanned", "rows of `unplanned.parquet`", |row| {
        row.run.record.unplanned_bonds.len() as u64
    });
    table.integer(
        "hops",
        "hops of messages from a block to its parent or child",
        |row| row.run.record.hops,
    );
    table.unsigned("seed", "seed of the ensemble", |row| row.run.manifest.seed);
    table
}
