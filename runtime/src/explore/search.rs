//! Depth first through all states.
use std::collections::HashSet;

use super::Exploration;
use super::faults::Doom;
use super::fingerprint::fingerprint;
use super::judge::{Judge, Wrong};
use super::reduce::Reducer;
use super::report::{Bound, Report, Verdict};
use super::state::{Setting, State};
use super::step::Step;

/// Bytes of the set of visited states per entry, with the room that it keeps free.
const ENTRY: usize = 40;

/// A state on the way, with the steps that are still to be tried.
struct Visit<'t> {
    state: State<'t>,
    todo: Vec<Step>,
    /// The step that is being tried.
    tried: Option<Step>,
}

/// Everything about one search.
pub(super) struct Search<'s, 't> {
    exploration: &'s Exploration<'t>,
    setting: Setting<'t>,
    judge: Judge<'t>,
    reducer: Option<Reducer<'t>>,
    visited: HashSet<u128>,
    way: Vec<Visit<'t>>,
    weight: usize,
    work: u64,
    transitions: u64,
    hangs: u64,
}

impl<'s, 't> Search<'s, 't> {
    pub fn new(exploration: &'s Exploration<'t>, doom: &'t Doom) -> Search<'s, 't> {
        let setting = Setting::new(exploration, doom);
        Search {
            exploration,
            setting,
            judge: exploration.judge(),
            reducer: exploration.reduce.then(|| Reducer::new(setting)),
            visited: HashSet::new(),
            way: Vec::new(),
            weight: 0,
            work: 0,
            transitions: 0,
            hangs: 0,
        }
    }

    /// Goes through all states, and adds what it finds to a report.
    pub fn run(mut self, report: &mut Report) {
        report.verdict = self.verdict();
        report.states += self.visited.len() as u64;
        report.transitions += self.transitions;
        report.hangs += self.hangs;
        report.work += self.work;
    }

    fn verdict(&mut self) -> Verdict {
        let (first, effects) = State::first(&self.setting);
        if let Some(wrong) = self.judge.effects(&effects) {
            return self.violated(wrong);
        }
        if let Some(verdict) = self.enter(first) {
            return verdict;
        }
        while let Some(visit) = self.way.last_mut() {
            let Some(step) = visit.todo.pop() else {
                self.weight -= visit.state.weight();
                self.way.pop();
                continue;
            };
            visit.tried = Some(step);
            let mut state = visit.state.clone();
            let effects = state.make(&self.setting, step);
            self.transitions += 1;
            if let Some(wrong) = self.judge.step(&visit.state, step, &effects) {
                return self.violated(wrong);
            }
            if let Some(verdict) = self.enter(state) {
                return verdict;
            }
        }
        Verdict::Holds
    }

    /// Takes a state up, unless it has been before; says when that ends the search.
    fn enter(&mut self, state: State<'t>) -> Option<Verdict> {
        if !self.visited.insert(fingerprint(&state)) {
            return None;
        }
        let bounds = &self.exploration.bounds;
        if self.visited.len() as u64 > bounds.states {
            return Some(Verdict::Unfinished(Bound::States));
        }
        self.weight += state.weight();
        if self.weight + self.visited.len() * ENTRY > bounds.memory {
            return Some(Verdict::Unfinished(Bound::Memory));
        }
        if self.work > bounds.work {
            return Some(Verdict::Unfinished(Bound::Work));
        }
        let unplanned = self.judge.unplanned(&self.setting, &state);
        let mut todo = state.steps(&self.setting);
        self.work += todo.len() as u64 + state.structure.blocks().len() as u64;
        if let Some(reducer) = &mut self.reducer {
            todo = reducer.choose(&state, todo);
            self.work += std::mem::take(&mut reducer.work);
        }
        let stuck = if todo.is_empty() {
            self.judge.hang(&state)
        } else {
            None
        };
        // The first is tried first.
        todo.reverse();
        self.way.push(Visit {
            state,
            todo,
            tried: None,
        });
        if let Some(wrong) = unplanned {
            return Some(self.violated(wrong));
        }
        if let Some(wrong) = stuck {
            if !self.exploration.hangs_allowed {
                return Some(self.violated(wrong));
            }
            self.hangs += 1;
        }
        None
    }

    fn violated(&self, wrong: Wrong) -> Verdict {
        let steps: Vec<Step> = self.way.iter().filter_map(|visit| visit.tried).collect();
        let phase = (self.way.last()).and_then(|visit| visit.state.structure.phase());
        self.judge.violated(&self.setting, wrong, phase, &steps)
    }
}
