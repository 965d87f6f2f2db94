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
//! What does not only add, and these are the dependences:
//!
//! 1. *The end of a phase* clears everything. It depends on all steps. T is no good if the plate
//!    may get all its reports without T.
//! 2. *A cell* takes one block: two captures into one cell. With a [`Reach`](super::Reach), also
//!    a capture that may close the way to another cell. (More blocks never open a way, so a cell
//!    that can be reached when all cells are full that may ever be is no concern.)
//! 3. *Letting go* takes away a block, its name and the ways through it. It depends on whatever
//!    may touch the two blocks: capture there, or send a message on a way that may lead through.
//! 4. *What should wait.* Whether an event comes too early is seen only in its order with the
//!    other one. (In right tables the later one cannot happen without the earlier.)
//! 5. *A fault* at a block depends on whatever may touch the block; the fates of one message depend
//!    on each other. Where blocks die, while a stray is still to come, and where blocks are
//!    mistaken about how they sit, all steps are tried: for deaths, a smaller set has been seen to
//!    miss one of 21 hangs of a random program.
//! 6. Two rules that give *the same name* in one phase: the way to a name is then not known in
//!    advance. The compiler makes no such tables; where they occur, all steps are tried.
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

use super::Reach;
use super::bench::Effects;
use super::future::{Captors, Future};
use super::roles::Roles;
use super::state::{Setting, State};
use super::step::Step;

/// Steps around which a persistent set is looked for, at most.
const CANDIDATES: usize = 64;

/// Chooses steps.
pub(super) struct Reducer<'t> {
    setting: Setting<'t>,
    /// Rules looked at and blocks copied, for bounding the work.
    pub work: u64,
    /// By phase.
    captors: Vec<Rc<Captors>>,
}

/// What a step has to do with.
struct Footprint {
    /// The cell it fills.
    cell: Option<Cell>,
    /// The captures and releases it brings.
    events: Vec<News>,
    /// The blocks it lets go, and those that let go.
    released: Roles,
    /// All blocks that it may touch.
    touched: Roles,
}

impl<'t> Reducer<'t> {
    pub fn new(setting: Setting<'t>) -> Reducer<'t> {
        let captors = Captors::by_phase(setting.tables);
        Reducer {
            captors: captors.into_iter().map(Rc::new).collect(),
            setting,
            work: 0,
        }
    }

    /// A persistent set of `steps`, all that are possible in `state`.
    pub fn choose(&mut self, state: &State<'t>, steps: Vec<Step>) -> Vec<Step> {
        let Some(phase) = state.structure.phase() else {
            return steps;
        };
        // To send again, and what comes of a message that its receiver has had, is nobody else's
        // affair (dependence 7).
        let again = |step: &&Step| step.flight().is_some_and(|f| f.is_waiting || f.is_taken);
        if let Some(first) = steps.iter().find(again) {
            let fates = steps.iter().filter(|step| is_same_matter(first, step));
            return fates.copied().collect();
        }
        let captors = Rc::clone(&self.captors[phase.0 as usize]);
        let doom = self.setting.doom;
        let strays_to_come = doom.strays.iter().any(|cell| !state.strayed.contains(cell));
        if steps.len() < 2
            || captors.is_ambiguous()
            || !doom.dead.is_empty()
            || !doom.mistaken.is_empty()
            || strays_to_come
            || steps.contains(&Step::EndPhase)
        {
            return steps;
        }
        let mut best: Option<Vec<Step>> = None;
        for &step in steps.iter().take(CANDIDATES) {
            let set = self.close(state, &captors, &steps, step);
            let is_better = |set: &Vec<Step>| best.as_ref().is_none_or(|b| set.len() < b.len());
            let Some(set) = set.filter(is_better) else {
                continue;
            };
            if set.iter().all(|other| is_same_matter(&step, other)) {
                return set;
            }
            best = Some(set);
        }
        best.unwrap_or(steps)
    }

    /// The smallest persistent set around a step that can be found by adding steps that depend on
    /// it; `None`: none but all.
    fn close(
        &mut self,
        state: &State<'t>,
        captors: &Captors,
        steps: &[Step],
        first: Step,
    ) -> Option<Vec<Step>> {
        let mut set: Vec<Step> = Vec::new();
        let mut prints: Vec<Footprint> = Vec::new();
        for &step in steps.iter().filter(|step| is_same_matter(&first, step)) {
            set.push(step);
            prints.push(self.footprint(state, captors, step));
        }
        loop {
            let future = Future::of(&self.setting, captors, state, &set)?;
            self.work += future.looked_at;
            if !self.conflict(state, &prints, &future) {
                return Some(set);
            }
            let before = set.len();
            for &step in steps {
                if set.contains(&step) {
                    continue;
                }
                let print = self.footprint(state, captors, step);
                let depends = |other: &Footprint| depend(&print, other);
                if prints.iter().any(depends) || set.iter().any(|s| is_same_matter(s, &step)) {
                    prints.push(print);
                    set.push(step);
                }
            }
            if set.len() == before || set.len() == steps.len() {
                return None;
            }
        }
    }

    fn footprint(&mut self, state: &State<'t>, captors: &Captors, step: Step) -> Footprint {
        let none = || Roles::none(self.setting.tables.roles.len());
        let (mut released, mut touched) = (none(), none());
        self.work += state.structure.blocks().len() as u64;
        let mut after = state.clone();
        let effects: Effects = after.make(&self.setting, step);
        let mut cell = None;
        if let Some(flight) = step.flight() {
            for at in [flight.from, flight.to]
                .into_iter()
                .filter_map(|at| state.role(at))
            {
                captors.add_way(state, at, &flight.message, &mut touched);
            }
        }
        match step {
            Step::Capture(site) => {
                cell = state.lattice.target(site);
                touched.extend_with(effects.captured.iter().copied());
                touched.extend_with(state.role(site.body));
            }
            Step::Die(role) => {
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

    /// Whether something of the future depends on one of the steps.
    fn conflict(&self, state: &State<'t>, prints: &[Footprint], future: &Future) -> bool {
        let phases = &self.setting.tables.phases;
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
                .setting
                .reach
                .is_some_and(|reach| closes(state, prints, future, reach))
    }
}

impl Reducer<'_> {
    /// Whether an event of the future should wait for one of the step, or the other way round.
    fn is_ordered(&self, state: &State<'_>, print: &Footprint, future: &Future) -> bool {
        let Some(stage) = state.stage(self.setting.expected) else {
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

/// Whether two steps are the same, or different fates of the same message.
fn is_same_matter(a: &Step, b: &Step) -> bool {
    a == b || (a.flight().is_some() && a.flight() == b.flight())
}

/// Whether two steps depend on each other.
fn depend(a: &Footprint, b: &Footprint) -> bool {
    (a.cell.is_some() && a.cell == b.cell)
        || a.released.meets(&b.touched)
        || a.touched.meets(&b.released)
}
