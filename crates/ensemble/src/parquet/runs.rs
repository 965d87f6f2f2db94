//! `runs.parquet`.
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;

use super::column::{
    ColumnDefinition, TableDefinition, integer, integers, real, text, texts, unsigned,
};
use super::row::{RunRow, key, outcome};
use crate::manifest::SweepAxes;

/// The phase in which a run ended without being complete.
pub(super) fn unfinished(record: &RunRecord) -> Option<PhaseId> {
    match record.outcome {
        Outcome::Completed => None,
        Outcome::TimedOut { phase, .. } | Outcome::Failed { phase, .. } => Some(phase),
    }
}

pub(super) fn table<'a>(axes: &SweepAxes<'_>) -> TableDefinition<'a, RunRow<'a, ()>> {
    type R<'a> = RunRow<'a, ()>;
    let mut columns = key(axes);
    columns.extend([
        ColumnDefinition::new(
            "assembly",
            "",
            "name of the assembly or aggregate",
            text(|row: &R<'a>| row.run.program.assembly()),
        ),
        ColumnDefinition::new(
            "scene",
            "",
            "name of the scene",
            text(|row: &R<'a>| row.run.program.scene.name.as_str()),
        ),
        ColumnDefinition::new(
            "outcome",
            "",
            "`completed`; `timed_out`: stopped by the timeout of a phase, its time is infinite; `censored`: stopped by \
             `--max-ticks`, its time is longer; `failed`: the physics broke down, its time means nothing",
            text(|row: &R<'a>| outcome(&row.run.record.outcome)),
        ),
        ColumnDefinition::new(
            "failed_phase",
            "",
            "name of the phase that was stopped or failed",
            text(|row: &R<'a>| {
                let phase = unfinished(row.run.record)?;
                Some(row.run.program.phase(phase))
            }),
        )
        .null("it completed"),
        ColumnDefinition::new(
            "failed_phase_number",
            "",
            "index of that phase, from 0",
            integer(|row: &R<'a>| unfinished(row.run.record).map(|phase| phase.0.into())),
        )
        .null("it completed"),
        ColumnDefinition::new(
            "reason",
            "",
            "why it failed",
            text(|row: &R<'a>| match &row.run.record.outcome {
                Outcome::Failed { reason, .. } => Some(reason.as_str()),
                Outcome::Completed | Outcome::TimedOut { .. } => None,
            }),
        )
        .null("it did not fail"),
        ColumnDefinition::new(
            "ticks",
            "ticks",
            "time until its end",
            integer(|row: &R<'a>| row.run.record.ticks),
        ),
        ColumnDefinition::new(
            "seconds",
            "s",
            "the same in seconds of the scene",
            real(|row: &R<'a>| row.run.seconds(row.run.record.ticks)),
        ),
        ColumnDefinition::new(
            "tick_seconds",
            "s",
            "length of a tick",
            real(|row: &R<'a>| row.run.program.scene.tick),
        ),
        ColumnDefinition::new(
            "phase_names",
            "",
            "names of all phases, by their index",
            texts(|row: &R<'a>| {
                let phases = row.run.program.phases().iter();
                phases.map(|phase| phase.name.as_str()).collect::<Vec<_>>()
            }),
        ),
        ColumnDefinition::new(
            "phase_ticks",
            "ticks",
            "time that each phase took which was completed, by its index; `phases.parquet` has the others as well",
            integers(|row: &R<'a>| row.run.record.phase_ticks.as_slice()),
        ),
        ColumnDefinition::new(
            "blocks_used",
            "",
            "different blocks that were captured; of an aggregate, blocks of the largest group",
            integer(|row: &R<'a>| u64::from(row.run.record.blocks_used)),
        ),
        ColumnDefinition::new(
            "captures",
            "",
            "rows of `bonds.parquet` that are not censored",
            integer(|row: &R<'a>| row.run.record.bonds.len() as u64),
        ),
        ColumnDefinition::new(
            "under_way",
            "",
            "rows of `bonds.parquet` that are censored",
            integer(|row: &R<'a>| row.run.record.waiting.len() as u64),
        ),
        ColumnDefinition::new(
            "releases",
            "",
            "rows of `releases.parquet`",
            integer(|row: &R<'a>| row.run.record.releases.len() as u64),
        ),
        ColumnDefinition::new(
            "unplanned",
            "",
            "rows of `unplanned.parquet`",
            integer(|row: &R<'a>| row.run.record.unplanned_bonds.len() as u64),
        ),
        ColumnDefinition::new(
            "hops",
            "",
            "hops of messages from a block to its parent or child",
            integer(|row: &R<'a>| row.run.record.hops),
        ),
        ColumnDefinition::new(
            "seed",
            "",
            "seed of the ensemble",
            unsigned(|row: &R<'a>| row.run.manifest.seed),
        ),
    ]);
    TableDefinition {
        name: "runs",
        row: "a finished run",
        columns,
    }
}
