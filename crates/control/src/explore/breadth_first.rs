//! Breadth-first search: the shortest order of events that violates a property, after reduction.
use std::collections::{HashSet, VecDeque};

use super::Exploration;
use super::checker::Breach;
use super::context::ExplorationContext;
use super::faults::FaultChoice;
use super::fingerprint::fingerprint;
use super::persistent::PersistentSets;
use super::report::ExplorationVerdict;
use super::state::ProgramState;
use super::transition::Transition;

/// Searches for the shortest violation. Returns [`ExplorationVerdict::Holds`] if there is none
/// within the bounds.
pub(super) fn shortest<'t>(
    exploration: &Exploration<'t>,
    struck: &'t FaultChoice,
) -> ExplorationVerdict {
    let context = ExplorationContext::new(exploration, struck);
    let checker = exploration.checker();
    let mut persistent = exploration.reduce.then(|| PersistentSets::new(context));
    // Predecessor of each state, and the transition from it.
    let mut arrivals: Vec<(usize, Option<Transition>)> = vec![(0, None)];
    let violated = |wrong: Breach,
                    arrivals: &[(usize, Option<Transition>)],
                    at: usize,
                    state: &ProgramState<'_>,
                    last: Option<Transition>| {
        let mut transitions: Vec<Transition> = last.into_iter().collect();
        let mut at = at;
        while let (before, Some(transition)) = arrivals[at] {
            transitions.push(transition);
            at = before;
        }
        transitions.reverse();
        checker.violated(&context, wrong, state.structure.phase(), &transitions)
    };
    let (first, effects) = ProgramState::first(&context);
    if let Some(wrong) = checker.effects(&effects) {
        return violated(wrong, &arrivals, 0, &first, None);
    }
    let mut visited = HashSet::from([fingerprint(&first)]);
    let mut weight = first.weight();
    let mut queue = VecDeque::from([(0, first)]);
    while let Some((at, state)) = queue.pop_front() {
        weight -= state.weight();
        if let Some(wrong) = checker.unplanned(&context, &state) {
            return violated(wrong, &arrivals, at, &state, None);
        }
        let mut transitions = state.transitions(&context);
        if let Some(persistent) = &mut persistent {
            transitions = persistent.choose(&state, transitions);
        }
        if let Some(wrong) = checker.hang(&state, &transitions) {
            return violated(wrong, &arrivals, at, &state, None);
        }
        for transition in transitions {
            let mut next = state.clone();
            let effects = next.make(&context, transition);
            if let Some(wrong) = checker.transition(&state, transition, &effects) {
                return violated(wrong, &arrivals, at, &state, Some(transition));
            }
            if visited.insert(fingerprint(&next)) {
                arrivals.push((at, Some(transition)));
                weight += next.weight();
                queue.push_back((arrivals.len() - 1, next));
            }
        }
        let bounds = &exploration.bounds;
        if visited.len() as u64 > bounds.states || weight > bounds.memory {
            break;
        }
    }
    ExplorationVerdict::Holds
}
