//! Depth-first search of all states.
use std::collections::HashSet;

use super::Exploration;
use super::checker::{Breach, PropertyChecker};
use super::context::ExplorationContext;
use super::faults::FaultChoice;
use super::fingerprint::fingerprint;
use super::persistent::PersistentSets;
use super::report::{ExceededBound, ExplorationReport, ExplorationVerdict};
use super::state::ProgramState;
use super::transition::Transition;

/// Memory per entry of the set of visited states, including spare capacity \[bytes\].
const ENTRY: usize = 40;

/// Visited state on the current path, with the transitions that remain to be tried.
struct Visit<'t> {
    state: ProgramState<'t>,
    todo: Vec<Transition>,
    /// Transition that is being tried.
    tried: Option<Transition>,
}

pub(super) struct DepthFirst<'s, 't> {
    exploration: &'s Exploration<'t>,
    context: ExplorationContext<'t>,
    checker: PropertyChecker<'t>,
    persistent: Option<PersistentSets<'t>>,
    visited: HashSet<u128>,
    path: Vec<Visit<'t>>,
    weight: usize,
    work: u64,
    transitions: u64,
    hangs: u64,
}

impl<'s, 't> DepthFirst<'s, 't> {
    pub fn new(exploration: &'s Exploration<'t>, struck: &'t FaultChoice) -> DepthFirst<'s, 't> {
        let context = ExplorationContext::new(exploration, struck);
        DepthFirst {
            exploration,
            context,
            checker: exploration.checker(),
            persistent: exploration.reduce.then(|| PersistentSets::new(context)),
            visited: HashSet::new(),
            path: Vec::new(),
            weight: 0,
            work: 0,
            transitions: 0,
            hangs: 0,
        }
    }

    /// Explores all states and adds the results to a report.
    pub fn run(mut self, report: &mut ExplorationReport) {
        report.verdict = self.verdict();
        report.states += self.visited.len() as u64;
        report.transitions += self.transitions;
        report.hangs += self.hangs;
        report.work += self.work;
    }

    fn verdict(&mut self) -> ExplorationVerdict {
        let (first, effects) = ProgramState::first(&self.context);
        if let Some(wrong) = self.checker.effects(&effects) {
            return self.violated(wrong);
        }
        if let Some(verdict) = self.enter(first) {
            return verdict;
        }
        while let Some(visit) = self.path.last_mut() {
            let Some(transition) = visit.todo.pop() else {
                self.weight -= visit.state.weight();
                self.path.pop();
                continue;
            };
            visit.tried = Some(transition);
            let mut state = visit.state.clone();
            let effects = state.make(&self.context, transition);
            self.transitions += 1;
            if let Some(wrong) = self.checker.transition(&visit.state, transition, &effects) {
                return self.violated(wrong);
            }
            if let Some(verdict) = self.enter(state) {
                return verdict;
            }
        }
        ExplorationVerdict::Holds
    }

    /// Enters a state unless it was visited before. Returns a verdict if the state ends the search.
    fn enter(&mut self, state: ProgramState<'t>) -> Option<ExplorationVerdict> {
        if !self.visited.insert(fingerprint(&state)) {
            return None;
        }
        let bounds = &self.exploration.bounds;
        if self.visited.len() as u64 > bounds.states {
            return Some(ExplorationVerdict::Unfinished(ExceededBound::States));
        }
        self.weight += state.weight();
        if self.weight + self.visited.len() * ENTRY > bounds.memory {
            return Some(ExplorationVerdict::Unfinished(ExceededBound::Memory));
        }
        if self.work > bounds.work {
            return Some(ExplorationVerdict::Unfinished(ExceededBound::Work));
        }
        let unplanned = self.checker.unplanned(&self.context, &state);
        let mut todo = state.transitions(&self.context);
        self.work += todo.len() as u64 + state.structure.count() as u64;
        if let Some(persistent) = &mut self.persistent {
            todo = persistent.choose(&state, todo);
            self.work += std::mem::take(&mut persistent.work);
        }
        let stuck = self.checker.hang(&state, &todo);
        // The list is used from its end.
        todo.reverse();
        self.path.push(Visit {
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

    fn violated(&self, wrong: Breach) -> ExplorationVerdict {
        let transitions: Vec<Transition> =
            self.path.iter().filter_map(|visit| visit.tried).collect();
        let phase = (self.path.last()).and_then(|visit| visit.state.structure.phase());
        self.checker
            .violated(&self.context, wrong, phase, &transitions)
    }
}
