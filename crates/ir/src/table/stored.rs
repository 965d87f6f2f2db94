//! Event tables in files, with validation on reading.
use std::collections::BTreeMap;

use serde::ser::SerializeStruct as _;
use serde::{Deserialize, Serialize, Serializer};

use super::{
    Action, Condition, Duty, InvalidTables, LooseDuty, Notification, Phase, PhaseId, Plate,
    Recovery, Role, RoleId, Rule, Tables, Trigger,
};
use crate::Cell;
use crate::scene::{BondKind, Planar};

/// Largest distance of a cell from the origin in each direction.
const FARTHEST: i32 = 100_000_000;

impl Serialize for Tables {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_struct("Tables", 8)?;
        out.serialize_field("assembly", &self.assembly)?;
        out.serialize_field("bond", &self.bond)?;
        out.serialize_field("faces", &self.faces)?;
        out.serialize_field("aggregate", &self.aggregate)?;
        out.serialize_field("plate", &self.plate)?;
        out.serialize_field("phases", &self.phases)?;
        out.serialize_field("roles", &self.roles)?;
        out.serialize_field("duties", &Duties(self))?;
        out.end()
    }
}

/// Serializer of the duties, one by one, without a second copy of all.
struct Duties<'a>(&'a Tables);

impl Serialize for Duties<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.duties())
    }
}

impl Serialize for Duty<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_struct("Duty", 4)?;
        out.serialize_field("role", &self.role)?;
        out.serialize_field("phase", &self.phase)?;
        out.serialize_field("trigger", &self.trigger)?;
        out.serialize_field("rules", &self.rules().collect::<Vec<Rule<'_>>>())?;
        out.end()
    }
}

/// Tables in the form of a file.
#[derive(Deserialize)]
pub(super) struct StoredTables {
    assembly: String,
    bond: BondKind,
    faces: u8,
    aggregate: Option<u32>,
    plate: Plate,
    phases: Vec<Phase>,
    roles: Vec<Role>,
    duties: Vec<StoredDuty>,
}

#[derive(Deserialize)]
struct StoredDuty {
    role: RoleId,
    phase: PhaseId,
    trigger: Trigger,
    rules: Vec<StoredRule>,
}

#[derive(Deserialize)]
struct StoredRule {
    when: Vec<Condition>,
    then: Action,
}

impl TryFrom<StoredTables> for Tables {
    type Error = InvalidTables;

    fn try_from(stored: StoredTables) -> Result<Tables, InvalidTables> {
        stored.validate()?;
        let duties = stored.duties.into_iter().map(|duty| -> LooseDuty {
            let rules = duty.rules.into_iter().map(|rule| (rule.when, rule.then));
            (duty.role, duty.phase, duty.trigger, rules.collect())
        });
        let mut tables = Tables::assemble(
            stored.assembly,
            stored.faces,
            stored.plate,
            stored.phases,
            stored.roles,
            duties.collect(),
        );
        tables.bond = stored.bond;
        tables.aggregate = stored.aggregate;
        Ok(tables)
    }
}

impl StoredTables {
    /// Validates all indices and numbers.
    fn validate(&self) -> Result<(), InvalidTables> {
        if !(1..=6).contains(&self.faces) {
            return Err(InvalidTables::Faces(self.faces));
        }
        self.validate_plate()?;
        match self.aggregate {
            Some(size) if self.phases.len() as u64 + 1 != u64::from(size) => {
                return Err(InvalidTables::AggregatePhases(size));
            }
            Some(_) if !self.duties.is_empty() || !self.roles.is_empty() => {
                return Err(InvalidTables::AggregateDuties);
            }
            _ => {}
        }
        let is_pre_attached = |phase: &Phase| phase.pre_attached;
        if self.phases.iter().skip(1).any(is_pre_attached) {
            return Err(InvalidTables::LatePreAttached);
        }
        self.validate_roles()?;
        let key = |duty: &StoredDuty| (duty.role, duty.phase, duty.trigger);
        if !self.duties.is_sorted_by(|a, b| key(a) < key(b)) {
            return Err(InvalidTables::DutyOrder);
        }
        self.duties
            .iter()
            .try_for_each(|duty| self.validate_duty(duty))?;
        self.validate_phases()
    }

    fn validate_roles(&self) -> Result<(), InvalidTables> {
        let mut indices = BTreeMap::new();
        for (second, role) in self.roles.iter().enumerate() {
            if let Some(first) = indices.insert(&*role.name, second) {
                return Err(InvalidTables::RoleName { first, second });
            }
        }
        Ok(())
    }

    /// Validates that phases can end, and only after their blocks have reported.
    fn validate_phases(&self) -> Result<(), InvalidTables> {
        let mut reports = vec![0; self.phases.len()];
        for duty in &self.duties {
            let all = duty.rules.iter().filter(|rule| rule.then == Action::Report);
            reports[duty.phase.0 as usize] += all.count() as u64;
        }
        for (phase, (found, made)) in self.phases.iter().zip(reports).enumerate() {
            let Phase {
                reports,
                timeout,
                recovery,
                ..
            } = *found;
            if u64::from(reports) != made {
                return Err(InvalidTables::Reports {
                    phase,
                    expected: reports,
                    made,
                });
            }
            if timeout == Some(0) {
                return Err(InvalidTables::Timeout(phase));
            }
            if recovery.is_some_and(|recovery| !self.is_recoverable(phase, recovery)) {
                return Err(InvalidTables::Recovery(phase));
            }
        }
        Ok(())
    }

    /// Returns whether a phase can be retried: it has a timeout, releases nothing, and expects as
    /// many reports as blocks capture in it at its start.
    fn is_recoverable(&self, number: usize, recovery: Recovery) -> bool {
        let duties = self.duties.iter();
        let duties = duties.filter(|duty| duty.phase.0 as usize == number);
        let releases = |rule: &StoredRule| {
            matches!(
                rule.then,
                Action::SwitchOff { .. } | Action::AskRelease | Action::AskReleaseLater(_)
            )
        };
        let captures = |rule: &StoredRule| matches!(rule.then, Action::Magnetize { .. });
        let at_start = duties.clone().filter(|duty| duty.trigger == Trigger::Start);
        let captors = at_start.filter(|duty| duty.rules.iter().any(captures));
        let phase = &self.phases[number];
        phase.timeout.is_some()
            && !phase.pre_attached
            && self.aggregate.is_none()
            && recovery.retries > 0
            && captors.count() as u64 == u64::from(recovery.reports)
            && !duties.flat_map(|duty| &duty.rules).any(releases)
    }

    fn validate_plate(&self) -> Result<(), InvalidTables> {
        let Plate { width, depth } = self.plate;
        if width.max(depth) > Plate::LONGEST {
            return Err(InvalidTables::PlateSize { width, depth });
        }
        let seeds = self.roles.iter().filter_map(|role| role.seed);
        let count = seeds.clone().count();
        if self
            .roles
            .iter()
            .take(count)
            .any(|role| role.seed.is_none())
        {
            return Err(InvalidTables::SeedOrder);
        }
        for Cell { x, y, z } in seeds {
            let within = |at: i32, size: u32| at >= 0 && (at as u32) < size;
            if !(z == 0 || z == Planar::LAYER) || !within(x, width) || !within(y, depth) {
                return Err(InvalidTables::SeedCell);
            }
        }
        Ok(())
    }

    fn validate_duty(&self, duty: &StoredDuty) -> Result<(), InvalidTables> {
        self.known(duty.role)?;
        if duty.phase.0 as usize >= self.phases.len() {
            return Err(InvalidTables::UnknownPhase(duty.phase.0));
        }
        for rule in &duty.rules {
            for when in &rule.when {
                match *when {
                    Condition::Docked(role)
                    | Condition::Asked(role)
                    | Condition::Released(role) => {
                        self.known(role)?;
                    }
                    Condition::Notified(notification) => self.known_of(notification)?,
                    Condition::Turn(_) => {}
                }
            }
            match rule.then {
                Action::Magnetize { child, cell, .. } => {
                    self.known(child)?;
                    let index = child.0 as usize;
                    if self.roles[index].seed.is_some() {
                        return Err(InvalidTables::CapturedSeed(index));
                    }
                    let far = |at: i32| at.unsigned_abs() > FARTHEST as u32;
                    if far(cell.x) || far(cell.y) || far(cell.z) {
                        return Err(InvalidTables::FarCell(cell));
                    }
                }
                Action::SwitchOff { child, .. } => self.known(child)?,
                Action::Notify { to, notification } => {
                    self.known(to)?;
                    self.known_of(notification)?;
                }
                Action::AskRelease | Action::AskReleaseLater(_) | Action::Report => {}
            }
        }
        Ok(())
    }

    fn known(&self, role: RoleId) -> Result<(), InvalidTables> {
        if (role.0 as usize) < self.roles.len() {
            Ok(())
        } else {
            Err(InvalidTables::UnknownRole(role))
        }
    }

    fn known_of(&self, notification: Notification) -> Result<(), InvalidTables> {
        let (Notification::Anchored(role) | Notification::Released(role)) = notification;
        self.known(role)
    }
}
