//! Depth first through all states.
use std::collections::HashSet;

use stochc_compiler::table::PhaseId;

use super::Exploration;
use super::fingerprint::fingerprint;
use super::judge::{Judge, Wrong};
use super::reduce::Reducer;
use super::report::{Bound, Report, Verdict, Violation};
use super::state::State;
use super::step::Step;
use super::story::Story;

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
    pub exploration: &'s Exploration<'t>,
    judge: Judge<'s>,
    reducer: Option<Reducer<'t>>,
    visited: HashSet<u128>,
    way: Vec<Visit<'t>>,
    weight: usize,
    transitions: u64,
    hangs: u64,
}

impl<'s, 't> Search<'s, 't> {
    pub fn new(exploration: &'s Exploration<'t>) -> Search<'s, 't> {
        Search {
            exploration,
            judge: exploration.judge(),
            reducer: exploration.reduce.then(|| Reducer::new(exploration.tables)),
            visited: HashSet::new(),
            way: Vec::new(),
            weight: 0,
            transitions: 0,
            hangs: 0,
        }
    }

    /// Goes through all states.
    pub fn run(mut self) -> Report {
        let verdict = self.verdict();
        Report {
            states: self.visited.len() as u64,
            transitions: self.transitions,
            schedules: 0,
            hangs: self.hangs,
            verdict,
        }
    }

    fn verdict(&mut self) -> Verdict {
        let exploration = self.exploration;
        let (first, effects) = State::first(exploration.tables);
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
            let effects = state.make(exploration.tables, step);
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
        let reach = self.exploration.reach;
        let mut todo = state.steps(reach);
        if let Some(reducer) = &self.reducer {
            todo = reducer.choose(&state, todo, reach);
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
        if let Some(wrong) = stuck {
            if !self.exploration.hangs_allowed {
                return Some(self.violated(wrong));
            }
            self.hangs += 1;
        }
        None
    }

    fn violated(&self, (property, what): Wrong) -> Verdict {
        let steps: Vec<Step> = self.way.iter().filter_map(|visit| visit.tried).collect();
        let phase = (self.way.last()).and_then(|visit| visit.state.structure.phase());
        Verdict::Violated(Box::new(Violation {
            property,
            phase: phase.unwrap_or(PhaseId(0)),
            what,
            trace: trace(self.exploration, &steps),
        }))
    }
}

/// Steps from the beginning, in words.
pub(super) fn trace(exploration: &Exploration<'_>, steps: &[Step]) -> Vec<String> {
    let story = Story {
        tables: exploration.tables,
    };
    let (mut state, _) = State::first(exploration.tables);
    let mut lines = Vec::new();
    for &step in steps {
        let before = state.clone();
        let effects = state.make(exploration.tables, step);
        lines.push(story.tell(&before, step, &effects));
    }
    lines
}
