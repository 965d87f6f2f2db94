//! What a record can say, and what no run of its program can have done.
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::Manifest;
use super::finished::Finished;

/// Why a line is of no run of the manifest; `None`: it may be.
pub(super) fn inconsistency(manifest: &Manifest, finished: &Finished) -> Option<String> {
    let Some(program) = manifest.programs.get(finished.program) else {
        return Some(format!("there is no program {}", finished.program));
    };
    let record = &finished.record;
    if record.run >= manifest.runs {
        return Some(manifest.no_such_run(record.run));
    }
    let ticks = record.ticks;
    match manifest.settings.max_ticks {
        Some(limit) if ticks > limit => {
            return Some(format!("{ticks} ticks are beyond `--max-ticks` ({limit})"));
        }
        _ => {}
    }
    if times(record).any(|tick| tick > ticks) {
        return Some("something happens after its end".to_owned());
    }
    let phases = program.phases().len();
    let is_phase = |phase: PhaseId| (phase.0 as usize) < phases;
    let is_role = |role: &RoleId| (role.0 as usize) < program.roles().len();
    if record.phase_ticks.len() > phases || !phases_of(record).all(is_phase) {
        return Some("its program has no such phase".to_owned());
    }
    // An aggregate has no roles, and no blocks that take one.
    let known = program.tables().aggregate.is_some() || roles(record).all(|role| is_role(&role));
    (!known).then(|| "its program has no such role".to_owned())
}

/// All times of a record, but that of its end.
fn times(record: &RunRecord) -> impl Iterator<Item = u64> {
    let bonds = record.bonds.iter();
    let phases = record
        .phase_ticks
        .iter()
        .try_fold(0u64, |sum, &ticks| sum.checked_add(ticks));
    (bonds.flat_map(|bond| [bond.magnetized, bond.docked]))
        .chain(record.waiting.iter().map(|wait| wait.magnetized))
        .chain(record.releases.iter().map(|release| release.tick))
        .chain(record.unplanned_bonds.iter().map(|bond| bond.tick))
        .chain([phases.unwrap_or(u64::MAX)])
}

fn phases_of(record: &RunRecord) -> impl Iterator<Item = PhaseId> {
    let end = match record.outcome {
        Outcome::Completed => None,
        Outcome::TimedOut { phase, .. } | Outcome::Failed { phase, .. } => Some(phase),
    };
    (record.bonds.iter().map(|bond| bond.phase))
        .chain(record.waiting.iter().map(|wait| wait.phase))
        .chain(record.releases.iter().map(|release| release.phase))
        .chain(record.unplanned_bonds.iter().map(|bond| bond.phase))
        .chain(end)
}

fn roles(record: &RunRecord) -> impl Iterator<Item = RoleId> {
    (record
        .bonds
        .iter()
        .flat_map(|bond| [bond.parent, bond.child]))
    .chain(
        record
            .waiting
            .iter()
            .flat_map(|wait| [wait.parent, wait.child]),
    )
    .chain(record.releases.iter().flat_map(|it| [it.parent, it.child]))
    .chain(record.unplanned_bonds.iter().map(|bond| bond.parent))
}
