//! `runs.parquet`: one row per finished run.
use stochc_runtime::record::{Outcome, RunRecord};

use super::column::{Column, file, integer};
use crate::ensemble::{Finished, Manifest};

/// The table of runs, which are sorted by program and run.
///
/// | column | type | what |
/// |---|---|---|
/// | `program` | text | its name |
/// | `run` | integer | its number, from 0 |
/// | `outcome` | text | `completed`, `timed_out` (the time is censored) or `failed` |
/// | `failed_phase` | text or null | the phase in which it timed out or failed |
/// | `reason` | text or null | why it failed |
/// | `ticks` | integer | until its end |
/// | `phase_ticks` | list of integers | of each phase that was completed |
/// | `blocks_used` | integer | different bodies that were captured |
/// | `captures` | integer | rows of the table of bonds |
/// | `hops` | integer | of messages |
/// | `seed` | unsigned integer | of the ensemble |
pub(in crate::ensemble) fn runs(manifest: &Manifest, finished: &[Finished]) -> Vec<u8> {
    let integers = |value: fn(&RunRecord) -> u64| {
        Column::Integers(
            finished
                .iter()
                .map(|done| integer(value(&done.record)))
                .collect(),
        )
    };
    let programs = finished.iter().map(|done| &manifest.programs[done.program]);
    let phases = finished.iter().map(|done| {
        let program = &manifest.programs[done.program];
        match done.record.outcome {
            Outcome::Completed => None,
            Outcome::TimedOut { phase } | Outcome::Failed { phase, .. } => {
                Some(program.phase(phase))
            }
        }
    });
    let reasons = finished.iter().map(|done| match &done.record.outcome {
        Outcome::Failed { reason, .. } => Some(reason.as_str()),
        Outcome::Completed | Outcome::TimedOut { .. } => None,
    });
    let outcomes = finished.iter().map(|done| match done.record.outcome {
        Outcome::Completed => "completed",
        Outcome::TimedOut { .. } => "timed_out",
        Outcome::Failed { .. } => "failed",
    });
    let phase_ticks = finished.iter().map(|done| &*done.record.phase_ticks);
    let columns = [
        (
            "program",
            Column::Texts(programs.map(|p| &*p.name).collect()),
        ),
        ("run", integers(|record| record.run)),
        ("outcome", Column::Texts(outcomes.collect())),
        ("failed_phase", Column::MaybeTexts(phases.collect())),
        ("reason", Column::MaybeTexts(reasons.collect())),
        ("ticks", integers(|record| record.ticks)),
        ("phase_ticks", Column::Lists(phase_ticks.collect())),
        ("blocks_used", integers(|record| record.blocks_used.into())),
        ("captures", integers(|record| record.bonds.len() as u64)),
        ("hops", integers(|record| record.hops)),
        (
            "seed",
            Column::Unsigned(vec![manifest.seed; finished.len()]),
        ),
    ];
    file("runs", &manifest.identity(), &columns)
}
