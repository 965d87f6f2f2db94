//! Event tables in files, with validation on reading.
use std::collections::BTreeMap;

use serde::ser::SerializeStruct as _;
use serde::{Deserialize, Serialize, Serializer};

use super::{
    Action, Condition, Duty, LooseDuty, News, Phase, PhaseId, Plate, Role, RoleId, Rule, Tables,
    Trigger,
};
use crate::Cell;
use crate::scene::BondKind;

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

/// Duties serialized one by one, without a second copy of all.
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
    type Error = String;

    fn try_from(stored: StoredTables) -> Result<Tables, String> {
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
    fn validate(&self) -> Result<(), String> {
        if !(1..=6).contains(&self.faces) {
            return Err(format!("a block has no {} faces", self.faces));
        }
        self.validate_plate()?;
        match self.aggregate {
            Some(size) if self.phases.len() as u64 + 1 != u64::from(size) => {
                return Err(format!(
                    "an aggregate of {size} blocks has a phase for each size"
                ));
            }
            Some(_) if !self.duties.is_empty() || !self.roles.is_empty() => {
                return Err("the blocks of an aggregate have nothing to do".to_owned());
            }
            _ => {}
        }
        let is_planted = |phase: &Phase| phase.planted;
        if self.phases.iter().skip(1).any(is_planted) {
            return Err("only the first phase can be attached by hand".to_owned());
        }
        self.validate_roles()?;
        let key = |duty: &StoredDuty| (duty.role, duty.phase, duty.trigger);
        if !self.duties.is_sorted_by(|a, b| key(a) < key(b)) {
            return Err("the duties are not sorted, or one comes twice".to_owned());
        }
        self.duties
            .iter()
            .try_for_each(|duty| self.validate_duty(duty))?;
        self.validate_phases()
    }

    fn validate_roles(&self) -> Result<(), String> {
        let mut places = BTreeMap::new();
        for (place, role) in self.roles.iter().enumerate() {
            if let Some(other) = places.insert(&*role.name, place) {
                return Err(format!(
                    "`tables.roles[{place}].name` is that of `tables.roles[{other}]`"
                ));
            }
        }
        Ok(())
    }

    /// Validates that phases can end, and only after their blocks have reported.
    fn validate_phases(&self) -> Result<(), String> {
        let mut reports = vec![0; self.phases.len()];
        for duty in &self.duties {
            let all = duty.rules.iter().filter(|rule| rule.then == Action::Report);
            reports[duty.phase.0 as usize] += all.count() as u64;
        }
        for (place, (phase, made)) in self.phases.iter().zip(reports).enumerate() {
            let Phase {
                reports, timeout, ..
            } = *phase;
            if u64::from(reports) != made {
                return Err(format!(
                    "`tables.phases[{place}].reports` is {reports}, and its blocks make {made}"
                ));
            }
            if timeout == Some(0) {
                return Err(format!(
                    "`tables.phases[{place}].timeout` is 0: it is at least 1, or null"
                ));
            }
        }
        Ok(())
    }

    fn validate_plate(&self) -> Result<(), String> {
        let Plate { width, depth } = self.plate;
        if width.max(depth) > Plate::LONGEST {
            return Err(format!("a plate of {width} x {depth} blocks is too large"));
        }
        let seeds = self.roles.iter().filter_map(|role| role.seed);
        let count = seeds.clone().count();
        if self
            .roles
            .iter()
            .take(count)
            .any(|role| role.seed.is_none())
        {
            return Err("seeds come first among the roles".to_owned());
        }
        for Cell { x, y, z } in seeds {
            let within = |at: i32, size: u32| at >= 0 && (at as u32) < size;
            if z != 0 || !within(x, width) || !within(y, depth) {
                return Err("a seed is not on the plate".to_owned());
            }
        }
        Ok(())
    }

    fn validate_duty(&self, duty: &StoredDuty) -> Result<(), String> {
        self.known(duty.role)?;
        if duty.phase.0 as usize >= self.phases.len() {
            return Err(format!("there is no phase {}", duty.phase.0));
        }
        for rule in &duty.rules {
            for when in &rule.when {
                match *when {
                    Condition::Docked(role)
                    | Condition::Asked(role)
                    | Condition::Released(role) => {
                        self.known(role)?;
                    }
                    Condition::Heard(news) => self.known_of(news)?,
                    Condition::Turn(_) => {}
                }
            }
            match rule.then {
                Action::Magnetize { child, cell, .. } => {
                    self.known(child)?;
                    let place = child.0 as usize;
                    if self.roles[place].seed.is_some() {
                        return Err(format!(
                            "`tables.roles[{place}].seed` is a cell, and a block is captured in that role"
                        ));
                    }
                    let far = |at: i32| at.unsigned_abs() > FARTHEST as u32;
                    if far(cell.x) || far(cell.y) || far(cell.z) {
                        return Err(format!("{cell} is too far away"));
                    }
                }
                Action::SwitchOff { child, .. } => self.known(child)?,
                Action::Tell { to, news } => {
                    self.known(to)?;
                    self.known_of(news)?;
                }
                Action::AskRelease | Action::Report => {}
            }
        }
        Ok(())
    }

    fn known(&self, role: RoleId) -> Result<(), String> {
        if (role.0 as usize) < self.roles.len() {
            Ok(())
        } else {
            Err(format!("there is no role {}", role.0))
        }
    }

    fn known_of(&self, news: News) -> Result<(), String> {
        let (News::Anchored(role) | News::Released(role)) = news;
        self.known(role)
    }
}
