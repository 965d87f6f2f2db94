//! The control that `stochc` verifies, ahead of the interpreters: its messages take no time.
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use stochc_control::{
    BlockFace, Body, Docking, Environment, Lattice, Message, Payload, PlannedCapture, Recalled,
    Structure,
};
use stochc_ir::table::Tables;

/// Structure, cells and messages in transit.
#[derive(Clone)]
pub struct Control<'t> {
    pub structure: Structure<'t>,
    pub effects: Effects,
}

/// Effects of the structure.
#[derive(Clone, Default)]
pub struct Effects {
    pub lattice: Lattice,
    in_transit: Vec<(Body, Body, Message)>,
    closed: Vec<BlockFace>,
    /// Time of the interpreters \[ticks\].
    pub now: u32,
    /// Whether times may end early.
    pub is_timeless: bool,
    /// Earliest times of delayed requests, by the block that asks.
    due: BTreeMap<Body, u32>,
    /// Number of delayed releases.
    pub delayed: usize,
}

impl Environment for Effects {
    type Mark = ();

    fn magnetize(&mut self, block_face: BlockFace, _capture: &PlannedCapture) {
        self.lattice.magnetize(block_face);
    }

    fn switch_off(&mut self, block_face: BlockFace) {
        self.closed.push(block_face);
        self.lattice.switch_off(block_face);
    }

    fn send(&mut self, from: Body, to: Body, message: Message) {
        self.in_transit.push((from, to, message));
    }

    fn send_later(&mut self, from: Body, to: Body, message: Message, ticks: u32) {
        self.due.insert(from, self.now.saturating_add(ticks));
        self.send(from, to, message);
    }

    fn recall(&mut self, left: Body, _unreceived: u32) -> Recalled {
        self.due.remove(&left);
        let mut recalled = Recalled::default();
        self.in_transit.retain(|&(from, to, message)| {
            if to == left {
                recalled.to.push(message);
            } else if from == left {
                recalled.from.push(message);
            }
            to != left && from != left
        });
        recalled
    }

    fn clear_messages(&mut self) {
        self.in_transit.clear();
        self.due.clear();
    }
}

impl<'t> Control<'t> {
    pub fn new(tables: &'t Tables) -> Control<'t> {
        let mut control = Control {
            structure: Structure::new(tables),
            effects: Effects::default(),
        };
        control.structure.start(&mut control.effects);
        control.deliver();
        control
    }

    /// Delivers all messages except requests for release: the interpreters decide when those
    /// arrive.
    fn deliver(&mut self) {
        let is_open =
            |(_, _, message): &(Body, Body, Message)| !matches!(message.payload, Payload::Ask(_));
        while let Some(i) = self.effects.in_transit.iter().position(is_open) {
            let (from, to, message) = self.effects.in_transit.remove(i);
            self.structure.receive(from, to, message, &mut self.effects);
        }
    }

    /// Docks a block.
    pub fn dock(&mut self, docking: &Docking) {
        self.effects.lattice.dock(docking);
        self.structure.dock(docking, &mut self.effects);
        self.deliver();
    }

    /// Releases the block `child` of `parent`, which must have requested this.
    pub fn release(&mut self, parent: BlockFace, child: Body) -> Result<(), String> {
        let is_request = |&(from, to, message): &(Body, Body, Message)| {
            (from, to) == (child, parent.body) && matches!(message.payload, Payload::Ask(_))
        };
        let position = self.effects.in_transit.iter().position(is_request);
        let position =
            position.ok_or_else(|| format!("{child:?} has not asked for its release"))?;
        let (from, to, message) = self.effects.in_transit.remove(position);
        if let Some(due) = self.effects.due.remove(&child) {
            if self.effects.now < due && !self.effects.is_timeless {
                return Err(format!(
                    "released in tick {} instead of {due}",
                    self.effects.now
                ));
            }
            self.effects.delayed += 1;
        }
        self.effects.closed.clear();
        self.structure.receive(from, to, message, &mut self.effects);
        self.deliver();
        if self.effects.closed == [parent] {
            return Ok(());
        }
        Err(format!("{:?} instead of {parent:?}", self.effects.closed))
    }

    /// Begins the next phase.
    pub fn next_phase(&mut self) -> Result<(), String> {
        if !self.structure.is_phase_reported() || !self.effects.lattice.active().is_empty() {
            return Err(format!("phase {:?} is not over", self.structure.phase()));
        }
        self.structure.next_phase(&mut self.effects);
        self.deliver();
        Ok(())
    }

    /// Aborts the phase. Blocks that hold none of its blocks ask for their release.
    pub fn abort(&mut self) -> Result<(), String> {
        if !self.structure.can_abort() {
            return Err("the phase cannot be aborted".into());
        }
        self.structure.abort(&mut self.effects);
        self.deliver();
        Ok(())
    }

    /// Begins the aborted phase again.
    pub fn retry(&mut self) -> Result<(), String> {
        if !self.structure.is_aborting() || !self.structure.is_phase_reported() {
            return Err("the abort is not over".into());
        }
        self.structure.retry(&mut self.effects);
        self.deliver();
        Ok(())
    }

    /// Returns a hash of the state.
    pub fn hash(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let mut in_transit = self.effects.in_transit.clone();
        in_transit.sort();
        (&self.structure, &self.effects.lattice, in_transit).hash(&mut hasher);
        hasher.finish()
    }

    pub fn is_complete(&self) -> bool {
        self.structure.phase().is_none()
    }
}
