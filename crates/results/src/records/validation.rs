//! Validation of records against their program.
use stochc_ir::record::{Origin, Outcome, RunRecord};
use stochc_ir::table::{PhaseId, RoleId};

use crate::Manifest;
use crate::records::ProgramEvents;

pub(crate) struct RecordValidator<'m> {
    manifest: &'m Manifest,
    programs: Vec<ProgramEvents<'m>>,
}

impl<'m> RecordValidator<'m> {
    pub fn new(manifest: &'m Manifest) -> RecordValidator<'m> {
        let programs = manifest.programs.iter();
        RecordValidator {
            manifest,
            programs: programs.map(ProgramEvents::new).collect(),
        }
    }

    /// Returns the reason why a record cannot belong to a run of the manifest's program `number`.
    /// Returns `None` if the record is valid.
    pub fn inconsistency(&self, number: usize, record: &RunRecord) -> Option<String> {
        let Some(program) = self.manifest.programs.get(number) else {
            return Some(format!("program {number} does not exist"));
        };
        if record.run >= self.manifest.runs {
            return Some(self.manifest.no_such_run(record.run));
        }
        let ticks = record.ticks;
        match self.manifest.settings.max_ticks {
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
        if record.phase_ticks.len() > phases || !phases_of(record).all(is_phase) {
            return Some("its program has no such phase".to_owned());
        }
        let free = program.scene.free.count;
        if bodies(record).any(|body| body >= free) {
            return Some("its scene has no such block".to_owned());
        }
        // An aggregate has no roles.
        if program.tables().aggregate.is_some() {
            return None;
        }
        let is_role = |role: RoleId| (role.0 as usize) < program.roles().len();
        if !roles(record).all(is_role) {
            return Some("its program has no such role".to_owned());
        }
        let order = self.programs[number].check(record);
        order.err().map(str::to_owned)
    }
}

/// Returns all ticks that occur in a record, except the end of the run.
fn times(record: &RunRecord) -> impl Iterator<Item = u64> {
    let bonds = record.all_bonds();
    let phases = record
        .phase_ticks
        .iter()
        .try_fold(0u64, |sum, &ticks| sum.checked_add(ticks));
    let aborts = record.aborts.iter();
    (bonds.flat_map(|bond| [bond.magnetized, bond.docked]))
        .chain(record.all_waiting().map(|(wait, _)| wait.magnetized))
        .chain(record.all_releases().map(|release| release.tick))
        .chain(aborts.flat_map(|it| [it.began, it.tick, it.retried.unwrap_or(0)]))
        .chain(record.unplanned_bonds.iter().map(|bond| bond.tick))
        .chain(record.faults.iter().map(|fault| fault.tick))
        .chain([phases.unwrap_or(u64::MAX)])
}

fn phases_of(record: &RunRecord) -> impl Iterator<Item = PhaseId> {
    let end = match record.outcome {
        Outcome::Completed => None,
        Outcome::TimedOut { phase, .. } | Outcome::Failed { phase, .. } => Some(phase),
    };
    (record.all_bonds().map(|bond| bond.phase))
        .chain(record.all_waiting().map(|(wait, _)| wait.phase))
        .chain(record.all_releases().map(|release| release.phase))
        .chain(record.aborts.iter().map(|abort| abort.phase))
        .chain(record.unplanned_bonds.iter().map(|bond| bond.phase))
        .chain(record.faults.iter().map(|fault| fault.phase))
        .chain(end)
}

fn bodies(record: &RunRecord) -> impl Iterator<Item = u32> {
    (record.all_bonds().map(|bond| bond.body))
        .chain(record.all_releases().map(|release| release.body))
        .chain(record.unplanned_bonds.iter().map(|bond| bond.body))
        .chain(record.faults.iter().map(|fault| fault.body))
}

fn roles(record: &RunRecord) -> impl Iterator<Item = RoleId> {
    let origins = record.all_bonds().filter_map(|bond| match bond.origin {
        Origin::Free => None,
        Origin::Released { role, .. } => Some(role),
    });
    (record
        .all_bonds()
        .flat_map(|bond| [bond.parent, bond.child]))
    .chain(
        record
            .all_waiting()
            .flat_map(|(wait, _)| [wait.parent, wait.child]),
    )
    .chain(record.all_releases().flat_map(|it| [it.parent, it.child]))
    .chain(record.unplanned_bonds.iter().map(|bond| bond.parent))
    .chain(record.faults.iter().map(|fault| fault.child))
    .chain(origins)
}
