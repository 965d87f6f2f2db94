//! State of a program: structure, cells, and messages in transit.
use std::collections::BTreeSet;

use stochc_ir::table::RoleId;
use stochc_ir::{Cell, Face};

use super::context::ExplorationContext;
use super::effects::{Effects, Mistake};
use super::environment::StateEnvironment;
use super::expected::{PhaseGoal, ProgramGoals};
use super::progress::PhaseProgress;
use super::report::Property;
use super::transition::{Ignored, InTransit, Transition};
use crate::{BlockFace, Body, Channels, Docking, Lattice, Structure, StructureBlock};

/// State of a program. Equal states have the same future.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct ProgramState<'t> {
    pub structure: Structure<'t>,
    pub lattice: Lattice,
    /// Messages in transit, sorted.
    pub in_transit: Vec<InTransit>,
    /// Numbers of message transfers, used if messages can be lost. Comparisons of states ignore
    /// them, because `in_transit` contains the same transfers.
    pub channels: Ignored<Channels>,
    /// Events so far in this phase, for the check at the end of the phase.
    pub done: PhaseProgress,
    /// Cells of stray blocks so far.
    pub strayed: BTreeSet<Cell>,
    /// Open faces with a block that has not acknowledged its name.
    pub silent: BTreeSet<BlockFace>,
    /// Number of silent blocks so far.
    pub silenced: u8,
}

impl<'t> ProgramState<'t> {
    /// Returns the state at the start of the first phase.
    pub fn first(context: &ExplorationContext<'t>) -> (ProgramState<'t>, Effects) {
        let mut state = ProgramState {
            structure: Structure::new(context.tables),
            lattice: Lattice::default(),
            in_transit: Vec::new(),
            channels: Ignored(Channels::default()),
            done: PhaseProgress::default(),
            strayed: BTreeSet::new(),
            silent: BTreeSet::new(),
            silenced: 0,
        };
        let mut effects = state.carry_out(context, |structure, environment| {
            structure.start(environment)
        });
        // Pre-attached blocks are present before any other event.
        while state.structure.is_planting() {
            while let Some((block_face, _)) = state.structure.next_to_plant() {
                effects
                    .faults
                    .append(&mut state.capture(context, block_face, 0).faults);
            }
            let mut ended = state.make(context, Transition::EndPhase);
            effects.faults.append(&mut ended.faults);
        }
        (state, effects)
    }

    /// Returns a face whose unplanned capture would have a lasting effect, or `None` if every such
    /// capture is rejected without effect.
    ///
    /// Tries every exposed face in turn.
    pub fn unsettled(&self, context: &ExplorationContext<'t>) -> Option<BlockFace> {
        let mut state = self.clone();
        let mut first = None;
        for block in self.structure.blocks() {
            for face in Face::ALL {
                let body = block.body();
                let block_face = BlockFace { body, face };
                let is_open = block.open().iter().any(|open| open.own == face);
                if is_open || block.is_dead() || self.lattice.target(block_face).is_none() {
                    continue;
                }
                first = first.or(Some(block_face));
                let docking = docking(block_face, context.first_stray(), 0);
                state.lattice.dock(&docking);
                let effects = state.carry_out(context, |structure, environment| {
                    structure.dock(&docking, environment)
                });
                let is_noticed = !effects.sent.is_empty()
                    || !effects.faults.is_empty()
                    || !effects.captured.is_empty()
                    || !effects.opened.is_empty();
                if is_noticed || effects.closed != [block_face] {
                    return Some(block_face);
                }
            }
        }
        first.filter(|_| state != *self)
    }

    pub fn is_complete(&self) -> bool {
        self.structure.phase().is_none()
    }

    /// Returns the enabled transitions: messages first, then captures, then the end of the phase.
    pub fn transitions(&self, context: &ExplorationContext<'t>) -> Vec<Transition> {
        let mut transitions = Vec::new();
        if self.is_complete() {
            return transitions;
        }
        for (i, &transit) in self.in_transit.iter().enumerate() {
            if i > 0 && self.in_transit[i - 1] == transit {
                continue;
            }
            if transit.is_waiting {
                transitions.push(Transition::SendAgain(transit));
                continue;
            }
            transitions.push(Transition::Arrive(transit));
            if transit.lost < context.faults.lost {
                transitions.push(Transition::Lose(transit));
                transitions.push(Transition::LoseAnswer(transit));
            }
        }
        self.add_captures(context, &mut transitions);
        transitions.extend(self.silent.iter().map(|face| Transition::Answer(*face)));
        for &role in &context.struck.dead {
            let block = self.structure.holder(role);
            if block.is_some_and(|block| !block.is_dead()) {
                transitions.push(Transition::Die(role));
            }
        }
        let is_reported = self.structure.is_phase_reported();
        if self.structure.is_aborting() && is_reported {
            transitions.push(Transition::Retry);
        } else if !self.structure.is_aborting() && is_reported {
            transitions.push(Transition::EndPhase);
        }
        if self.can_abort(context) {
            transitions.push(Transition::Abort);
        }
        transitions
    }

    /// Returns whether the phase may reach its timeout. Time is not explored, so this may happen
    /// at any moment before the last report.
    ///
    /// Without silent blocks, each phase is aborted at most once. A retry begins with the state at
    /// the start of the phase, which is checked, so further aborts would add no new states. With
    /// silent blocks, a phase is aborted only if it holds one. It would otherwise have no retry
    /// left for a later one.
    pub fn can_abort(&self, context: &ExplorationContext<'_>) -> bool {
        let structure = &self.structure;
        let is_tried = match context.faults.silent {
            0 => structure.aborts() == 0,
            _ => !self.silent.is_empty(),
        };
        structure.can_abort() && is_tried && !structure.is_phase_reported()
    }

    fn add_captures(&self, context: &ExplorationContext<'t>, transitions: &mut Vec<Transition>) {
        let occupied = context.reach.map(|_| self.occupied());
        let can_come = |cell| match (context.reach, &occupied) {
            (Some(reach), Some(occupied)) => reach(occupied, cell),
            _ => true,
        };
        for &block_face in self.lattice.active() {
            let Some(_) = self
                .lattice
                .target(block_face)
                .filter(|cell| can_come(*cell))
            else {
                continue;
            };
            let child = self.opened(block_face);
            if child.is_some_and(|child| context.struck.mistaken.contains(&child)) {
                transitions.extend((1..24).map(|how| Transition::CaptureMistaken(block_face, how)));
            } else {
                transitions.push(Transition::Capture(block_face));
                if self.may_be_silent(context) && child.is_some() {
                    transitions.push(Transition::Hold(block_face));
                }
            }
        }
        for &cell in &context.struck.strays {
            if self.strayed.contains(&cell) || self.lattice.cells().contains_key(&cell) {
                continue;
            }
            for block in self.structure.blocks() {
                for face in Face::ALL {
                    let body = block.body();
                    let block_face = BlockFace { body, face };
                    if self.lattice.target(block_face) == Some(cell)
                        && !self.lattice.active().contains(&block_face)
                        && can_come(cell)
                    {
                        transitions.push(Transition::Stray(block_face));
                    }
                }
            }
        }
    }

    /// Returns whether the next captured block may be silent.
    pub fn may_be_silent(&self, context: &ExplorationContext<'_>) -> bool {
        self.silenced < context.faults.silent
    }

    /// Returns the occupied cells above the plate.
    pub fn occupied(&self) -> BTreeSet<Cell> {
        self.lattice.cells().keys().copied().collect()
    }

    /// Makes a transition that [`ProgramState::transitions`] has returned.
    pub fn make(&mut self, context: &ExplorationContext<'t>, transition: Transition) -> Effects {
        match transition {
            Transition::Arrive(transit) => self.arrive(context, transit, true),
            Transition::LoseAnswer(transit) => self.arrive(context, transit, false),
            Transition::Lose(transit) => {
                self.remove(&transit);
                if context.faults.sent_again {
                    self.insert(InTransit {
                        lost: transit.lost + 1,
                        is_waiting: true,
                        ..transit
                    });
                }
                Effects::default()
            }
            Transition::SendAgain(transit) => {
                self.remove(&transit);
                self.insert(InTransit {
                    is_waiting: false,
                    ..transit
                });
                Effects::default()
            }
            Transition::Capture(block_face) => self.capture(context, block_face, 0),
            Transition::Hold(block_face) => {
                let child = self.opened(block_face).map_or(u32::MAX, |child| child.0);
                self.lattice.dock(&docking(block_face, child, 0));
                self.silent.insert(block_face);
                self.silenced += 1;
                Effects::default()
            }
            Transition::Answer(block_face) => {
                self.silent.remove(&block_face);
                self.capture(context, block_face, 0)
            }
            Transition::CaptureMistaken(block_face, how) => self.capture(context, block_face, how),
            Transition::Stray(block_face) => {
                self.strayed.extend(self.lattice.target(block_face));
                let cell = self.lattice.target(block_face);
                let index = context
                    .struck
                    .strays
                    .iter()
                    .position(|at| Some(*at) == cell);
                let number = context.first_stray() + index.unwrap_or(0) as u32;
                let docking = docking(block_face, number, 0);
                self.lattice.dock(&docking);
                self.carry_out(context, |structure, environment| {
                    structure.dock(&docking, environment)
                })
            }
            Transition::Die(role) => {
                if let Some(body) = self.structure.holder(role).map(StructureBlock::body) {
                    self.structure.kill(body);
                }
                Effects::default()
            }
            Transition::Abort => {
                self.done.reports.clear();
                self.carry_out(context, |structure, environment| {
                    structure.abort(environment)
                })
            }
            Transition::Retry => {
                self.done = PhaseProgress::default();
                self.carry_out(context, |structure, environment| {
                    structure.retry(environment)
                })
            }
            Transition::EndPhase => {
                self.done = PhaseProgress::default();
                let phase = self.structure.phase();
                let next = phase.map(|phase| phase.0 as usize + 1);
                self.carry_out_in(context, next, |structure, environment| {
                    structure.next_phase(environment)
                })
            }
        }
    }

    fn arrive(
        &mut self,
        context: &ExplorationContext<'t>,
        transit: InTransit,
        is_answered: bool,
    ) -> Effects {
        self.remove(&transit);
        let InTransit { from, to, .. } = transit;
        let number = transit.number.0;
        let with_losses = context.faults.lost > 0;
        let is_dead = |body| {
            let block = self.structure.block(body);
            block.is_some_and(|block| block.is_dead())
        };
        // A failed block neither accepts nor acknowledges the message. Resending it forever changes
        // nothing.
        if with_losses && is_dead(to) {
            return Effects::default();
        }
        let is_new = !with_losses || self.channels.0.take(from, to, number);
        if is_answered && with_losses {
            self.channels.0.acknowledge(from, to, number);
        } else if !is_answered && context.faults.sent_again && !is_dead(from) {
            self.insert(InTransit {
                lost: transit.lost + 1,
                is_taken: true,
                is_waiting: true,
                ..transit
            });
        }
        if !is_new {
            return Effects::default();
        }
        self.carry_out(context, |structure, environment| {
            structure.receive(from, to, transit.message, environment);
        })
    }

    fn remove(&mut self, transit: &InTransit) {
        if let Ok(i) = self.in_transit.binary_search(transit) {
            self.in_transit.remove(i);
        }
    }

    fn insert(&mut self, transit: InTransit) {
        let i = self.in_transit.partition_point(|other| *other <= transit);
        self.in_transit.insert(i, transit);
    }

    /// Captures a block at an open face. The block gets the number of its role, so that equal
    /// structures are equal states.
    fn capture(
        &mut self,
        context: &ExplorationContext<'t>,
        block_face: BlockFace,
        how: u8,
    ) -> Effects {
        let child = self.opened(block_face);
        let truth = docking(block_face, child.map_or(u32::MAX, |child| child.0), 0);
        let belief = docking(block_face, truth.child, how);
        let held = child.is_some_and(|child| self.structure.holder(child).is_some());
        self.lattice.dock(&truth);
        let mut effects = self.carry_out(context, |structure, environment| {
            structure.dock(&belief, environment)
        });
        if let Some(child) = child.filter(|_| held) {
            let fault = Mistake::SecondHolder(child);
            effects.faults.push((Property::OneHolder, fault));
        }
        effects
    }

    /// Returns the role of the block that an open face expects. Returns `None` if the face is not
    /// open.
    fn opened(&self, block_face: BlockFace) -> Option<RoleId> {
        let block = self.structure.block(block_face.body)?;
        let open = block
            .open()
            .iter()
            .find(|open| open.own == block_face.face)?;
        Some(open.child)
    }

    fn carry_out(
        &mut self,
        context: &ExplorationContext<'t>,
        act: impl FnOnce(&mut Structure<'t>, &mut StateEnvironment<'_>),
    ) -> Effects {
        let phase = self.structure.phase();
        let number = phase.map(|phase| phase.0 as usize);
        self.carry_out_in(context, number, act)
    }

    /// Carries out `act` and returns its effects. The events of `act` belong to the given phase.
    fn carry_out_in(
        &mut self,
        context: &ExplorationContext<'t>,
        phase: Option<usize>,
        act: impl FnOnce(&mut Structure<'t>, &mut StateEnvironment<'_>),
    ) -> Effects {
        let mut effects = Effects::default();
        let mut environment = StateEnvironment {
            stage: phase.and_then(|phase| context.expected.phases.get(phase)),
            faults: context.faults,
            first_stray: context.first_stray(),
            lattice: &mut self.lattice,
            in_transit: &mut self.in_transit,
            channels: &mut self.channels.0,
            done: &mut self.done,
            effects: &mut effects,
        };
        act(&mut self.structure, &mut environment);
        let lattice = &self.lattice;
        (self.silent).retain(|face| lattice.held(*face).is_some());
        for block_face in &effects.opened {
            let block = self.structure.block(block_face.body);
            let spare = usize::from(context.tables.faces.max(1));
            if let Some(block) = block.filter(|block| block.open().len() > spare) {
                let fault = Mistake::TooManyFaces(block.role());
                effects.faults.push((Property::Faces, fault));
            }
        }
        effects
    }

    /// Returns the role of a block of the structure. Returns `None` for any other block.
    pub fn role(&self, body: Body) -> Option<RoleId> {
        Some(self.structure.block(body)?.role())
    }

    /// Returns the goal of the running phase. Returns `None` after the last phase.
    pub fn stage<'e>(&self, expected: &'e ProgramGoals) -> Option<&'e PhaseGoal> {
        expected.phases.get(self.structure.phase()?.0 as usize)
    }

    /// Returns the approximate size of the state \[bytes\].
    pub fn weight(&self) -> usize {
        let of = std::mem::size_of::<ProgramState<'_>>();
        of + self.structure.count() * 512 + self.in_transit.len() * std::mem::size_of::<InTransit>()
    }
}

/// Returns the capture of a block at a face. `how` is the index of the block's orientation, from 0
/// to 23.
fn docking(block_face: BlockFace, child: u32, how: u8) -> Docking {
    let how = (how + 5) % 24;
    Docking {
        block_face,
        child,
        child_face: Face::ALL[usize::from(how / 4)],
        turn: how % 4,
        entries: 1,
        entered: 0,
    }
}
