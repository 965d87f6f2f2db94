//! Which of the possible transitions have to be tried.
//!
//! # Why fewer are enough
//!
//! Two transitions are *independent* in a state if neither prevents the other and both orders lead to
//! the same state. A set T of the transitions that are possible in a state is *persistent* if nothing
//! that can happen without a transition of T depends on one of T. Every maximal order of events from
//! there then has a transition of T in it (at its end those of T would still be possible), and the first
//! of them can be moved to the front, past what it does not depend on. So trying T alone finds,
//! for every maximal order, one in which the same transitions find the blocks that they touch in the
//! same state: every hang, every phase's end, and every transition that does something wrong (all of
//! these are seen at the blocks that the transition touches). The space has no circles, because every
//! transition uses up an event, a hop on the way to a goal, or a phase; so nothing is put off for ever.
//!
//! What is independent? Blocks only gather: the set of what a block has seen grows, a rule fires
//! when its conditions are in the set, once, and what it sends or switches on adds to a bag that
//! has no order. Two transitions that only add commute, even at the same block: a message that comes
//! before the capture it waits for lies there and goes on with it, after it, it goes on at once.
//! What does not only add, and these are the dependences:
//!
//! 1. *The end of a phase* clears everything. It depends on all transitions. T is no good if the plate
//!    may get all its reports without T.
//! 2. *A cell* takes one block: two captures into one cell. With a [`CanReach`](super::CanReach), also
//!    a capture that may close the way to another cell. (More blocks never open a way, so a cell
//!    that can be reached when all cells are full that may ever be is no concern.)
//! 3. *Letting go* takes away a block, its name and the ways through it. It depends on whatever
//!    may touch the two blocks: capture there, or send a message on a way that may lead through.
//! 4. *What should wait.* Whether an event comes too early is seen only in its order with the
//!    other one. (In right tables the later one cannot happen without the earlier.)
//! 5. *A fault* at a block depends on whatever may touch the block; the fates of one message depend
//!    on each other. Where blocks die, while a stray is still to come, and where blocks are
//!    mistaken about how they sit, all transitions are tried: for deaths, a smaller set has been seen to
//!    miss one of 21 hangs of a random program.
//! 6. Two rules that give *the same name* in one phase: the way to a name is then not known in
//!    advance. The compiler makes no such tables; where they occur, all transitions are tried.
//! 7. *Sending again* changes nothing but the message's own fate, nor does what becomes of one
//!    that its receiver has had: letting go hands over the same, the end of the phase clears the
//!    same. With it in front, any order of events goes on through the same states; so it is tried
//!    first, alone, although the end of the phase may take it away.
//!
//! What can happen without T is bounded by [`Future`], and all are checked against that bound.
use std::collections::BTreeSet;
use std::rc::Rc;

use stochc_ir::Cell;
use stochc_ir::table::News;

use super::CanReach;
use super::context::ExplorationContext;
use super::effects::Effects;
use super::future::{Future, PhaseCaptors};
use super::roles::RoleSet;
use super::state::ProgramState;
use super::transition::Transition;

/// Steps around which a persistent set is looked for, at most.
const CANDIDATES: usize = 64;

/// Chooses transitions.
pub(super) struct PersistentSets<'t> {
    context: ExplorationContext<'t>,
    /// Rules looked at and blocks copied, for bounding the work.
    pub work: u64,
    /// By phase.
    captors: Vec<Rc<PhaseCaptors>>,
}

/// What a transition has to do with.
struct Footprint {
    /// The cell it fills.
    cell: Option<Cell>,
    /// The captures and releases it brings.
    events: Vec<News>,
    /// The blocks it lets go, and those that let go.
    released: RoleSet,
    /// All blocks that it may touch.
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

    /// A persistent set of `transitions`, all that are possible in `state`.
    pub fn choose(
        &mut self,
        state: &ProgramState<'t>,
        transitions: Vec<Transition>,
    ) -> Vec<Transition> {
        let Some(phase) = state.structure.phase() else {
            return transitions;
        };
        // To send again, and what comes of a message that its receiver has had, is nobody else's
        // affair (dependence 7).
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

    /// The smallest persistent set around a transition that can be found by adding transitions that depend on
    /// it; `None`: none but all.
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
                captors.add_way(state, at, &transit.message, &mut touched);
            }
        }
        match transition {
            Transition::Capture(site) => {
                cell = state.lattice.target(site);
                touched.extend_with(effects.captured.iter().copied());
                touched.extend_with(state.role(site.body));
            }
            Transition::Die(role) => {
                released.insert(role);
                touched.insert(role);
            }
            _ => {}
        }
        for (from, message) in &effects.sent {
            if let Some(at) = after.role(*from).or_else(|| state.role(*from)) {
                captors.add_way(&after, at, message, &mut touched);
                captors.add_way(state, at, message, &mut touched);
            }
        }
        let closing = effects
            .closed
            .iter()
            .filter_map(|site| state.role(site.body));
        let gone = effects.released.iter().flat_map(|&(by, role)| [by, role]);
        for role in closing.chain(gone) {
            released.insert(role);
            touched.insert(role);
        }
        let captures = effects.captured.iter().map(|&role| News::Anchored(role));
        let releases = effects
            .released
            .iter()
            .map(|&(_, role)| News::Released(role));
        Footprint {
            cell,
            events: captures.chain(releases).collect(),
            released,
            touched,
        }
    }

    /// Whether something of the future depends on one of the transitions.
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
    /// Whether an event of the future should wait for one of the transition, or the other way round.
    fn is_ordered(&self, state: &ProgramState<'_>, print: &Footprint, future: &Future) -> bool {
        let Some(stage) = state.stage(self.context.expected) else {
            return false;
        };
        let waits = |event: &News, needed: &News| {
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

/// Whether the captures among the transitions may close the way to a cell of the future, or the other
/// way round.
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

/// Whether two transitions are the same, or different fates of the same message.
fn is_same_matter(a: &Transition, b: &Transition) -> bool {
    a == b || (a.transit().is_some() && a.transit() == b.transit())
}

/// Whether two transitions depend on each other.
fn depend(a: &Footprint, b: &Footprint) -> bool {
    (a.cell.is_some() && a.cell == b.cell)
        || a.released.meets(&b.touched)
        || a.touched.meets(&b.released)
}
