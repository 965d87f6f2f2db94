//! Persistent sets: the transitions that must be tried in a state.
//!
//! # Soundness
//!
//! Two transitions are *independent* in a state if neither prevents the other and their order does
//! not matter. A set T of enabled transitions is *persistent* if all events that can happen without
//! T are independent of T. Every maximal order of events then contains a transition of T. Otherwise
//! T would still be enabled at its end. The first transition of T can be moved to the front, past
//! independent transitions. Trying T alone therefore finds, for every maximal order, an equivalent
//! one. In both orders, each transition finds the same states of the blocks that it touches.
//! Deadlocks, ends of phases and faulty transitions are visible at the touched blocks, so the
//! search finds all of them. The state space has no cycles: every transition uses up an event, a
//! hop towards a goal, or a phase. Nothing is postponed forever.
//!
//! Blocks only accumulate observations. A rule fires once, when its conditions are in the set. Its
//! messages and open faces are added to an unordered multiset. Two transitions that only add
//! commute, even at the same block. A message that arrives before the capture that it needs waits
//! for the capture. If it arrives later, it continues at once. The other transitions have these
//! dependences:
//!
//! 1. *The end of a phase* clears everything and depends on all transitions. T is not valid if the
//!    plate may get all its reports without T.
//! 2. *A cell* holds one block: two captures into one cell depend on each other. With a
//!    [`CanReach`](super::CanReach), so do captures that may block access to another cell. More
//!    blocks never open access. A cell that is reachable with all possible cells occupied needs no
//!    check.
//! 3. *A release* removes a block, its name and the paths through it. It depends on everything that
//!    may touch the two blocks: captures there, and messages on paths that may lead through.
//! 4. *Order constraints* are checked only by the order of two events. In correct tables the later
//!    one cannot happen without the earlier.
//! 5. *A fault* at a block depends on everything that may touch the block. The losses of one
//!    message depend on each other. All transitions are tried if blocks fail, if a stray block may
//!    still come, if blocks are silent or may still be, or if blocks misjudge orientations. For
//!    failures, a smaller set missed one of 21 deadlocks of a random program.
//! 6. *Equal names*: if two rules give the same name in one phase, the path to the name is not
//!    known in advance. The compiler does not make such tables. All transitions are tried for them.
//! 7. *Resending* changes only the message's own state, as does a duplicate at its receiver. A
//!    release hands over the same messages, and the end of the phase clears them. Any order of
//!    events passes through the same states with resending in front. It is therefore tried first,
//!    alone, although the end of the phase may remove it.
//! 8. *An abort* clears everything, like the end of a phase. While it is possible, and until the
//!    aborted phase begins again, all transitions are tried.
//!
//! [`Future`] is an upper bound of the events without T, and all dependences are checked against
//! it.
use std::collections::BTreeSet;
use std::rc::Rc;

use stochc_ir::Cell;
use stochc_ir::table::Notification;

use super::CanReach;
use super::context::ExplorationContext;
use super::effects::Effects;
use super::future::{Future, PhaseCaptors};
use super::roles::RoleSet;
use super::state::ProgramState;
use super::transition::Transition;

/// Largest number of initial transitions tried for a persistent set.
const CANDIDATES: usize = 64;

/// Selector of persistent sets of transitions. If the search explores only such a set in each
/// state, the verdict stays the same (partial-order reduction).
pub(super) struct PersistentSets<'t> {
    context: ExplorationContext<'t>,
    /// Number of evaluated rules and copied blocks, for the work limit.
    pub work: u64,
    captors: Vec<Rc<PhaseCaptors>>,
}

/// Footprint of a transition: its cell, its events, and the blocks that it may touch.
struct Footprint {
    /// Cell that the transition fills.
    cell: Option<Cell>,
    /// Captures and releases that the transition causes.
    events: Vec<Notification>,
    /// Blocks that the transition releases, and their parents.
    released: RoleSet,
    /// All blocks that the transition may touch.
    touched: RoleSet,
}

impl<'t> PersistentSets<'t> {
    pub fn new(context: ExplorationContext<'t>) -> PersistentSets<'t> {
        let captors = PhaseCaptors::by_phase(context.tables);
        PersistentSets {
            captors: captors.into_iter().map(Rc::new).collect(),
            context,
            work: 0,
        }
    }

    /// Returns a persistent subset of `transitions`, which are all transitions enabled in `state`.
    pub fn choose(
        &mut self,
        state: &ProgramState<'t>,
        transitions: Vec<Transition>,
    ) -> Vec<Transition> {
        let Some(phase) = state.structure.phase() else {
            return transitions;
        };
        // Resending, and duplicates at a receiver, are independent of all others (dependence 7).
        let again = |transition: &&Transition| {
            transition
                .transit()
                .is_some_and(|f| f.is_waiting || f.is_taken)
        };
        if let Some(first) = transitions.iter().find(again) {
            let fates = transitions
                .iter()
                .filter(|transition| is_same_matter(first, transition));
            return fates.copied().collect();
        }
        let captors = Rc::clone(&self.captors[phase.0 as usize]);
        let struck = self.context.struck;
        let strays_to_come = struck
            .strays
            .iter()
            .any(|cell| !state.strayed.contains(cell));
        if transitions.len() < 2
            || captors.is_ambiguous()
            || !struck.dead.is_empty()
            || !struck.mistaken.is_empty()
            || strays_to_come
            || state.structure.is_aborting()
            || state.can_abort(&self.context)
            || state.may_be_silent(&self.context)
            || !state.silent.is_empty()
            || transitions.contains(&Transition::EndPhase)
        {
            return transitions;
        }
        let mut best: Option<Vec<Transition>> = None;
        for &transition in transitions.iter().take(CANDIDATES) {
            let set = self.close(state, &captors, &transitions, transition);
            let is_better =
                |set: &Vec<Transition>| best.as_ref().is_none_or(|b| set.len() < b.len());
            let Some(set) = set.filter(is_better) else {
                continue;
            };
            if set.iter().all(|other| is_same_matter(&transition, other)) {
                return set;
            }
            best = Some(set);
        }
        best.unwrap_or(transitions)
    }

    /// Extends a transition to a persistent set by adding dependent transitions. Returns `None` if
    /// only the set of all transitions is persistent.
    fn close(
        &mut self,
        state: &ProgramState<'t>,
        captors: &PhaseCaptors,
        transitions: &[Transition],
        first: Transition,
    ) -> Option<Vec<Transition>> {
        let mut set: Vec<Transition> = Vec::new();
        let mut prints: Vec<Footprint> = Vec::new();
        for &transition in transitions
            .iter()
            .filter(|transition| is_same_matter(&first, transition))
        {
            set.push(transition);
            prints.push(self.footprint(state, captors, transition));
        }
        loop {
            let future = Future::new(&self.context, captors, state, &set)?;
            self.work += future.looked_at;
            if !self.conflict(state, &prints, &future) {
                return Some(set);
            }
            let before = set.len();
            for &transition in transitions {
                if set.contains(&transition) {
                    continue;
                }
                let print = self.footprint(state, captors, transition);
                let depends = |other: &Footprint| depend(&print, other);
                if prints.iter().any(depends) || set.iter().any(|s| is_same_matter(s, &transition))
                {
                    prints.push(print);
                    set.push(transition);
                }
            }
            if set.len() == before || set.len() == transitions.len() {
                return None;
            }
        }
    }

    fn footprint(
        &mut self,
        state: &ProgramState<'t>,
        captors: &PhaseCaptors,
        transition: Transition,
    ) -> Footprint {
        let none = || RoleSet::none(self.context.tables.roles.len());
        let (mut released, mut touched) = (none(), none());
        self.work += state.structure.count() as u64;
        let mut after = state.clone();
        let effects: Effects = after.make(&self.context, transition);
        let mut cell = None;
        if let Some(transit) = transition.transit() {
            for at in [transit.from, transit.to]
                .into_iter()
                .filter_map(|at| state.role(at))
            {
                captors.add_path(state, at, &transit.message, &mut touched);
            }
        }
        match transition {
            Transition::Capture(block_face) => {
                cell = state.lattice.target(block_face);
                touched.extend_with(effects.captured.iter().copied());
                touched.extend_with(state.role(block_face.body));
            }
            Transition::Die(role) => {
                released.insert(role);
                touched.insert(role);
            }
            _ => {}
        }
        for (from, message) in &effects.sent {
            if let Some(at) = after.role(*from).or_else(|| state.role(*from)) {
                captors.add_path(&after, at, message, &mut touched);
                captors.add_path(state, at, message, &mut touched);
            }
        }
        let closing = effects
            .closed
            .iter()
            .filter_map(|block_face| state.role(block_face.body));
        let freed = effects.released.iter().flat_map(|&(by, role)| [by, role]);
        for role in closing.chain(freed) {
            released.insert(role);
            touched.insert(role);
        }
        let captures = effects
            .captured
            .iter()
            .map(|&role| Notification::Anchored(role));
        let releases = effects
            .released
            .iter()
            .map(|&(_, role)| Notification::Released(role));
        Footprint {
            cell,
            events: captures.chain(releases).collect(),
            released,
            touched,
        }
    }

    /// Returns whether the future depends on one of the transitions.
    fn conflict(&self, state: &ProgramState<'t>, prints: &[Footprint], future: &Future) -> bool {
        let phases = &self.context.tables.phases;
        let phase = state.structure.phase();
        let needed = phase.map_or(0, |phase| phases[phase.0 as usize].reports);
        future.reports >= needed
            || prints.iter().any(|print| {
                print.cell.is_some_and(|cell| future.cells.contains(&cell))
                    || self.is_ordered(state, print, future)
                    || print.released.meets(&future.touched)
                    || print.touched.meets(&future.released)
            })
            || self
                .context
                .reach
                .is_some_and(|reach| closes(state, prints, future, reach))
    }
}

impl PersistentSets<'_> {
    /// Returns whether the future and a transition have events with an order constraint.
    fn is_ordered(&self, state: &ProgramState<'_>, print: &Footprint, future: &Future) -> bool {
        let Some(stage) = state.stage(self.context.expected) else {
            return false;
        };
        let waits = |event: &Notification, needed: &Notification| {
            let needs = stage.needs.get(event);
            let turn = stage.turns.get(event);
            needs.is_some_and(|needs| needs.contains(needed))
                || turn.is_some_and(|(_, of)| of.contains(needed))
        };
        let mut pairs = print
            .events
            .iter()
            .flat_map(|a| future.events.iter().map(move |b| (a, b)));
        pairs.any(|(a, b)| waits(a, b) || waits(b, a))
    }
}

/// Returns whether a capture of the transitions may close the cell of a future capture, or the
/// reverse.
fn closes(
    state: &ProgramState<'_>,
    prints: &[Footprint],
    future: &Future,
    reach: &CanReach<'_>,
) -> bool {
    let own: Vec<Cell> = prints.iter().filter_map(|print| print.cell).collect();
    let mut full = state.occupied();
    full.extend(future.cells.iter().chain(&own));
    let mut unsafe_cell = |cell: &Cell| {
        full.remove(cell);
        let open = reach(&full, *cell);
        full.insert(*cell);
        !open
    };
    let closed_by_future = !future.cells.is_empty() && own.iter().any(&mut unsafe_cell);
    let later: BTreeSet<&Cell> = future.cells.iter().collect();
    closed_by_future || (!own.is_empty() && later.into_iter().any(unsafe_cell))
}

/// Returns whether two transitions are equal or move the same message.
fn is_same_matter(a: &Transition, b: &Transition) -> bool {
    a == b || (a.transit().is_some() && a.transit() == b.transit())
}

/// Returns whether two transitions depend on each other.
fn depend(a: &Footprint, b: &Footprint) -> bool {
    (a.cell.is_some() && a.cell == b.cell)
        || a.released.meets(&b.touched)
        || a.touched.meets(&b.released)
}
