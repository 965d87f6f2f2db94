//! Breadth first: the shortest order of events that goes wrong, of those that matter.
use std::collections::{HashSet, VecDeque};

use super::Exploration;
use super::faults::Doom;
use super::fingerprint::fingerprint;
use super::judge::Wrong;
use super::reduce::Reducer;
use super::report::Verdict;
use super::state::{Setting, State};
use super::step::Step;

/// Looks for it; [`Verdict::Holds`]: nothing goes wrong in as many states as may be visited.
pub(super) fn shortest<'t>(exploration: &Exploration<'t>, doom: &'t Doom) -> Verdict {
    let setting = Setting::new(exploration, doom);
    let judge = exploration.judge();
    let mut reducer = exploration.reduce.then(|| Reducer::new(setting));
    // How each state was come to first: from which, and by which step.
    let mut ways: Vec<(usize, Option<Step>)> = vec![(0, None)];
    let violated = |wrong: Wrong,
                    ways: &[(usize, Option<Step>)],
                    at: usize,
                    state: &State<'_>,
                    last: Option<Step>| {
        let mut steps: Vec<Step> = last.into_iter().collect();
        let mut at = at;
        while let (before, Some(step)) = ways[at] {
            steps.push(step);
            at = before;
        }
        steps.reverse();
        judge.violated(&setting, wrong, state.structure.phase(), &steps)
    };
    let (first, effects) = State::first(&setting);
    if let Some(wrong) = judge.effects(&effects) {
        return violated(wrong, &ways, 0, &first, None);
    }
    let mut visited = HashSet::from([fingerprint(&first)]);
    let mut weight = first.weight();
    let mut queue = VecDeque::from([(0, first)]);
    while let Some((at, state)) = queue.pop_front() {
        weight -= state.weight();
        if let Some(wrong) = judge.unplanned(&setting, &state) {
            return violated(wrong, &ways, at, &state, None);
        }
        let mut steps = state.steps(&setting);
        if let Some(reducer) = &mut reducer {
            steps = reducer.choose(&state, steps);
        }
        if steps.is_empty()
            && let Some(wrong) = judge.hang(&state)
        {
            return violated(wrong, &ways, at, &state, None);
        }
        for step in steps {
            let mut next = state.clone();
            let effects = next.make(&setting, step);
            if let Some(wrong) = judge.step(&state, step, &effects) {
                return violated(wrong, &ways, at, &state, Some(step));
            }
            if visited.insert(fingerprint(&next)) {
                ways.push((at, Some(step)));
                weight += next.weight();
                queue.push_back((ways.len() - 1, next));
            }
        }
        let bounds = &exploration.bounds;
        if visited.len() as u64 > bounds.states || weight > bounds.memory {
            break;
        }
    }
    Verdict::Holds
}
