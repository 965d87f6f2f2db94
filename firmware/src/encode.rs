//! Records of the roles in an image.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::table::{Action, Condition, Duty, PhaseId, RoleId, Rule, Tables, Trigger};

use crate::image::Unsupported;
use crate::nodes::{Node, Nodes};
use crate::sizes::Sizes;

/// Largest number of observations of a duty.
const MAX_OBSERVATIONS: usize = 127;

/// Writer of the records. It collects the sizes on the way.
pub struct Encoder<'a> {
    tables: &'a Tables,
    nodes: &'a Nodes,
    observations: usize,
    rules: usize,
    /// Notifications that can wait at a block in a phase: receiver and observation.
    waiting: BTreeMap<(PhaseId, Node), BTreeSet<(Node, u8)>>,
}

impl<'a> Encoder<'a> {
    pub fn new(tables: &'a Tables, nodes: &'a Nodes) -> Encoder<'a> {
        Encoder {
            tables,
            nodes,
            observations: 0,
            rules: 0,
            waiting: BTreeMap::new(),
        }
    }

    /// Returns the sizes of all records so far.
    pub fn sizes(&self) -> Sizes {
        let is_seed = |node: &Node| self.tables.roles[node.role.0 as usize].seed.is_some();
        let most = |on_plate: bool| {
            let places = self.waiting.iter();
            let counts = places
                .filter(|((_, node), _)| is_seed(node) == on_plate)
                .map(|(_, messages)| messages.len());
            counts.max().unwrap_or(0)
        };
        Sizes {
            observations: self.observations,
            rules: self.rules,
            waiting: most(false),
            plate_waiting: most(true),
            ..Sizes::default()
        }
    }

    /// Writes the record of a role.
    pub fn role(&mut self, role: u32, out: &mut Vec<u8>) -> Result<(), Unsupported> {
        let role = RoleId(role);
        let captures = self.nodes.captures(role);
        out.push(captures.len() as u8);
        for &(phase, parent) in captures {
            out.push(phase.0 as u8);
            out.extend(parent.number().to_le_bytes());
        }
        let count_at = out.len();
        out.push(0);
        for phase in 0..self.tables.phases.len() as u32 {
            for trigger in [Trigger::Start, Trigger::Anchored] {
                let node = Node { role, trigger };
                let is_written = self.duty(PhaseId(phase), node, out)?;
                out[count_at] += u8::from(is_written);
            }
        }
        Ok(())
    }

    /// Writes a duty. Returns whether the block has one.
    fn duty(&mut self, phase: PhaseId, node: Node, out: &mut Vec<u8>) -> Result<bool, Unsupported> {
        let duty = self.tables.duty(node.role, phase, node.trigger);
        let reports_anchored =
            node.trigger == Trigger::Anchored && self.nodes.is_pre_attached(phase, node.role);
        if duty.is_none() && !reports_anchored {
            return Ok(false);
        }
        let (own, notified) = duty.map_or_else(Default::default, observations);
        let mut body = vec![(own.len() as u8) | (u8::from(node.trigger == Trigger::Anchored) << 7)];
        body.extend(own.iter().flat_map(|&when| own_number(when).to_le_bytes()));
        let count_at = body.len();
        body.push(0);
        let mut rules = 0;
        for (index, rule) in duty.iter().flat_map(|duty| duty.rules()).enumerate() {
            let slots = |when: Condition| slot(&own, &notified, when);
            let conditions = conditions(duty, index, rule, slots);
            rules += self.rule(phase, rule, &conditions, &mut body);
        }
        if reports_anchored {
            body.extend([action_number(Action::Report), 0]);
            rules += 1;
        }
        let observed = own.len() + notified.len();
        let names = || {
            let phase = self.tables.phases[phase.0 as usize].name.clone();
            (self.tables.name(node.role).to_owned(), phase)
        };
        if observed > MAX_OBSERVATIONS {
            let (role, phase) = names();
            let count = observed;
            return Err(Unsupported::Observations { role, phase, count });
        }
        let Ok(count) = u8::try_from(rules) else {
            let (role, phase) = names();
            let count = rules;
            return Err(Unsupported::Rules { role, phase, count });
        };
        body[count_at] = count;
        self.observations = self.observations.max(observed);
        self.rules = self.rules.max(rules);
        out.push(phase.0 as u8);
        out.extend((body.len() as u16).to_le_bytes());
        out.extend(body);
        Ok(true)
    }

    /// Writes a rule, once for each receiver of its message. Returns the number of rules written.
    fn rule(
        &mut self,
        phase: PhaseId,
        rule: Rule<'_>,
        conditions: &[u8],
        out: &mut Vec<u8>,
    ) -> usize {
        let mut push = |operands: &[u8]| {
            out.push(action_number(rule.then));
            out.extend(conditions);
            out.extend(operands);
        };
        match rule.then {
            Action::Magnetize { child, .. } | Action::SwitchOff { child, .. } => {
                push(&(child.0 as u16).to_le_bytes());
            }
            Action::AskReleaseLater(ticks) => push(&ticks.saturating_add(1).to_le_bytes()),
            Action::AskRelease | Action::Report => push(&[]),
            Action::Notify { to, notification } => {
                let mut written = 0;
                for node in self.nodes.receivers(phase, to, notification) {
                    let Some(duty) = self.tables.duty(node.role, phase, node.trigger) else {
                        continue;
                    };
                    let (own, notified) = observations(duty);
                    let slot = slot(&own, &notified, Condition::Notified(notification));
                    let [low, high] = node.number().to_le_bytes();
                    push(&[low, high, slot]);
                    written += 1;
                    for place in self.nodes.waiting_places(phase, node) {
                        let waiting = self.waiting.entry((phase, place)).or_default();
                        waiting.insert((node, slot));
                    }
                }
                return written;
            }
        }
        1
    }
}

/// Returns the observations of a duty: sorted observations of own faces, and sorted notifications.
fn observations(duty: Duty<'_>) -> (Vec<Condition>, Vec<Condition>) {
    let mut own = BTreeSet::new();
    let mut notified = BTreeSet::new();
    for (index, rule) in duty.rules().enumerate() {
        for &when in rule.when {
            match when {
                Condition::Docked(_) | Condition::Asked(_) | Condition::Released(_) => {
                    own.insert(when);
                }
                Condition::Notified(_) => {
                    notified.insert(when);
                }
                Condition::Turn(_) => own.extend(duty.given_before(index).map(Condition::Docked)),
            }
        }
    }
    (own.into_iter().collect(), notified.into_iter().collect())
}

/// Returns the number of an observation in its duty.
fn slot(own: &[Condition], notified: &[Condition], when: Condition) -> u8 {
    let number = match own.binary_search(&when) {
        Ok(i) => i,
        Err(_) => own.len() + notified.binary_search(&when).unwrap_or_else(|i| i),
    };
    number as u8
}

/// Encodes the conditions of a rule.
fn conditions(
    duty: Option<Duty<'_>>,
    index: usize,
    rule: Rule<'_>,
    slot: impl Fn(Condition) -> u8,
) -> Vec<u8> {
    let mut out = vec![rule.when.len() as u8];
    for &when in rule.when {
        if let Condition::Turn(needed) = when {
            let given = duty.iter().flat_map(|duty| duty.given_before(index));
            let given: Vec<u8> = given.map(|role| slot(Condition::Docked(role))).collect();
            out.extend([0x80 | needed.min(127), given.len() as u8]);
            out.extend(given);
        } else {
            out.push(slot(when));
        }
    }
    out
}

/// Returns the number of an observation of an own face in an image.
fn own_number(when: Condition) -> u16 {
    match when {
        Condition::Docked(role) => role.0 as u16,
        Condition::Asked(role) => (role.0 as u16) | (1 << 14),
        Condition::Released(role) => (role.0 as u16) | (2 << 14),
        Condition::Notified(_) | Condition::Turn(_) => u16::MAX,
    }
}

/// Returns the first byte of a rule: its action, its face, and the number of its operand bytes.
fn action_number(action: Action) -> u8 {
    // The length of an operand, less one.
    const TWO: u8 = 1 << 6;
    const THREE: u8 = 2 << 6;
    const FOUR: u8 = 3 << 6;
    match action {
        Action::Magnetize { face, .. } => TWO | ((face as u8) << 3),
        Action::SwitchOff { face, .. } => TWO | 1 | ((face as u8) << 3),
        Action::AskRelease => 2,
        Action::Notify { .. } => THREE | 3,
        Action::Report => 4,
        Action::AskReleaseLater(_) => FOUR | 5,
    }
}
