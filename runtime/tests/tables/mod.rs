//! Event tables written by hand.
#![allow(dead_code, reason = "each test file writes other tables")]
use stochc_ir::table::{Action, Condition, Phase, PhaseId, Plate, Role, RoleId, Tables, Trigger};
use stochc_ir::{Cell, Face};

type Rules = Vec<(Vec<Condition>, Action)>;

/// Builder of tables on a plate of 3 x 3.
#[derive(Default)]
pub struct Draft {
    roles: Vec<Role>,
    phases: Vec<Phase>,
    duties: Vec<(RoleId, PhaseId, Trigger, Rules)>,
}

impl Draft {
    pub fn seed(&mut self, name: &str, x: i32, y: i32) -> RoleId {
        self.name(name, Some(Cell::new(x, y, 0)))
    }

    pub fn role(&mut self, name: &str) -> RoleId {
        self.name(name, None)
    }

    fn name(&mut self, name: &str, seed: Option<Cell>) -> RoleId {
        let name = name.to_owned();
        self.roles.push(Role { name, seed });
        RoleId(self.roles.len() as u32 - 1)
    }

    pub fn phase(&mut self, reports: u32) -> PhaseId {
        self.phases.push(Phase {
            name: format!("phase {}", self.phases.len()),
            timeout: None,
            wait: 0,
            reports,
            recovery: None,
            pre_attached: false,
        });
        PhaseId(self.phases.len() as u32 - 1)
    }

    /// Marks the blocks of a phase as pre-attached.
    pub fn plant(&mut self, phase: PhaseId) {
        self.phases[phase.0 as usize].pre_attached = true;
    }

    pub fn timeout(&mut self, phase: PhaseId, ticks: u64) {
        self.phases[phase.0 as usize].timeout = Some(ticks);
    }

    /// Sets the rules of `role` at the start of `phase`.
    pub fn start(&mut self, role: RoleId, phase: PhaseId, rules: Rules) {
        self.duties.push((role, phase, Trigger::Start, rules));
    }

    /// Sets the rules of `role` once it is captured in `phase`.
    pub fn anchored(&mut self, role: RoleId, phase: PhaseId, rules: Rules) {
        self.duties.push((role, phase, Trigger::Anchored, rules));
    }

    pub fn tables(self) -> Tables {
        let plate = Plate { width: 3, depth: 3 };
        Tables::assemble("test", 1, plate, self.phases, self.roles, self.duties)
    }
}

pub fn at_once(action: Action) -> (Vec<Condition>, Action) {
    (vec![], action)
}

pub fn magnetize(face: Face, child: RoleId, cell: Cell) -> Action {
    Action::Magnetize { face, child, cell }
}

/// Returns a chain from the seed at (1, 1). Each block captures the next one across the next face.
/// Also returns the roles of the chain, from the seed on, and their cells.
pub fn chain(faces: &[Face]) -> (Tables, Vec<(RoleId, Cell)>) {
    let mut draft = Draft::default();
    let phase = draft.phase(1);
    let mut cell = Cell::new(1, 1, 0);
    let mut role = draft.seed("T0", 1, 1);
    let mut roles = vec![(role, cell)];
    for (i, &face) in faces.iter().enumerate() {
        let child = draft.role(&format!("T{}", i + 1));
        cell = cell.across(face).expect("a short chain");
        let rules = vec![at_once(magnetize(face, child, cell))];
        if i == 0 {
            draft.start(role, phase, rules);
        } else {
            draft.anchored(role, phase, rules);
        }
        role = child;
        roles.push((role, cell));
    }
    draft.anchored(role, phase, vec![at_once(Action::Report)]);
    (draft.tables(), roles)
}
