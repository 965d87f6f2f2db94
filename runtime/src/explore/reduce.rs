//! Which of the possible steps have to be tried.
//!
//! # Why fewer are enough
//!
//! Two steps are *independent* in a state if neither prevents the other and both orders lead to
//! the same state. A set T of the steps that are possible in a state is *persistent* if nothing
//! that can happen without a step of T depends on one of T. Every maximal order of events from
//! there then has a step of T in it (at its end those of T would still be possible), and the first
//! of them can be moved to the front, past what it does not depend on. So trying T alone finds,
//! for every maximal order, one in which the same steps find the blocks that they touch in the
//! same state: every hang, every phase's end, and every step that does something wrong (all of
//! these are seen at the blocks that the step touches). The space has no circles, because every
//! step uses up an event, a hop on the way to a goal, or a phase; so nothing is put off for ever.
//!
//! What is independent? Blocks only gather: the set of what a block has seen grows, a rule fires
//! when its conditions are in the set, once, and what it sends or switches on adds to a bag that
//! has no order. Two steps that only add commute, even at the same block: a message that comes
//! before the capture it waits for lies there and goes on with it, after it, it goes on at once.
//! Four things do not only add, and they are the dependences:
//!
//! 1. *The end of a phase* clears everything. It depends on all steps. T is no good if the plate
//!    may get all its reports without T.
//! 2. *A cell* takes one block: two captures into one cell. With a [`Reach`](super::Reach), also
//!    a capture that may close the way to another cell. (More blocks never open a way, so a cell
//!    that can be reached when all cells are full that may ever be is no concern.)
//! 3. *Letting go* takes away a block, its name and the ways through it. It depends on whatever
//!    may touch the two blocks: capture there, or send a message on a way that may lead through.
//! 4. Two rules that give *the same name* in one phase: the way to a name is then not known in
//!    advance. The compiler makes no such tables; where they occur, all steps are tried.
//!
//! What can happen without T is bounded by [`Future`]. All four are checked against that bound.
use std::collections::BTreeSet;

use stochc_compiler::Cell;
use stochc_compiler::table::Tables;

use super::Reach;
use super::future::{Captors, Future};
use super::roles::Roles;
use super::state::{Effects, State};
use super::step::Step;

/// Chooses steps.
pub(super) struct Reducer<'t> {
    tables: &'t Tables,
    /// By phase.
    captors: Vec<Captors>,
}

/// What a step has to do with.
struct Footprint {
    /// The cell it fills.
    cell: Option<Cell>,
    /// The blocks it lets go, and those that let go.
    released: Roles,
    /// All blocks that it may touch.
    touched: Roles,
}

impl<'t> Reducer<'t> {
    pub fn new(tables: &'t Tables) -> Reducer<'t> {
        use stochc_compiler::table::PhaseId;
        let phases = 0..tables.phases.len() as u32;
        let captors = phases.map(|phase| Captors::of(tables, PhaseId(phase)));
        Reducer {
            tables,
            captors: captors.collect(),
        }
    }

    /// A persistent set of `steps`, all that are possible in `state`.
    pub fn choose(
        &self,
        state: &State<'t>,
        steps: Vec<Step>,
        reach: Option<&Reach<'_>>,
    ) -> Vec<Step> {
        let Some(phase) = state.structure.phase() else {
            return steps;
        };
        let captors = &self.captors[phase.0 as usize];
        if steps.len() < 2 || captors.is_ambiguous() || steps.contains(&Step::EndPhase) {
            return steps;
        }
        let mut best: Option<Vec<Step>> = None;
        for &step in &steps {
            let Some(set) = self.close(state, captors, &steps, step, reach) else {
                continue;
            };
            if set.len() == 1 {
                return set;
            }
            if best.as_ref().is_none_or(|best| set.len() < best.len()) {
                best = Some(set);
            }
        }
        best.unwrap_or(steps)
    }

    /// The smallest persistent set around a step that can be found by adding steps that depend on
    /// it; `None`: none.
    fn close(
        &self,
        state: &State<'t>,
        captors: &Captors,
        steps: &[Step],
        first: Step,
        reach: Option<&Reach<'_>>,
    ) -> Option<Vec<Step>> {
        let mut set = vec![first];
        let mut prints = vec![self.footprint(state, captors, first)];
        loop {
            let future = Future::of(self.tables, captors, state, &set)?;
            if !self.conflict(state, &prints, &future, reach) {
                return Some(set);
            }
            let before = set.len();
            for &step in steps {
                if set.contains(&step) {
                    continue;
                }
                let print = self.footprint(state, captors, step);
                if prints.iter().any(|other| depend(&print, other)) {
                    prints.push(print);
                    set.push(step);
                }
            }
            if set.len() == before || set.len() == steps.len() {
                return None;
            }
        }
    }

    fn footprint(&self, state: &State<'t>, captors: &Captors, step: Step) -> Footprint {
        let none = || Roles::none(self.tables.roles.len());
        let (mut released, mut touched) = (none(), none());
        let mut after = state.clone();
        let effects: Effects = after.make(self.tables, step);
        let mut cell = None;
        match step {
            Step::Arrive(flight) => {
                if let Some(at) = state.role(flight.to) {
                    captors.add_way(state, at, &flight.message, &mut touched);
                }
            }
            Step::Capture(site) => {
                cell = state.lattice.target(site);
                touched.extend_with(effects.captured.iter().copied());
                touched.extend_with(state.role(site.body));
            }
            Step::EndPhase => {}
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
        Footprint {
            cell,
            released,
            touched,
        }
    }

    /// Whether something of the future depends on one of the steps.
    fn conflict(
        &self,
        state: &State<'t>,
        prints: &[Footprint],
        future: &Future,
        reach: Option<&Reach<'_>>,
    ) -> bool {
        let phase = state.structure.phase();
        let needed = phase.map_or(0, |phase| self.tables.phases[phase.0 as usize].reports);
        future.reports >= needed
            || prints.iter().any(|print| {
                print.cell.is_some_and(|cell| future.cells.contains(&cell))
                    || print.released.meets(&future.touched)
                    || print.touched.meets(&future.released)
            })
            || reach.is_some_and(|reach| closes(state, prints, future, reach))
    }
}

/// Whether the captures among the steps may close the way to a cell of the future, or the other
/// way round.
fn closes(state: &State<'_>, prints: &[Footprint], future: &Future, reach: &Reach<'_>) -> bool {
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

/// Whether two steps depend on each other.
fn depend(a: &Footprint, b: &Footprint) -> bool {
    (a.cell.is_some() && a.cell == b.cell)
        || a.released.meets(&b.touched)
        || a.touched.meets(&b.released)
}
