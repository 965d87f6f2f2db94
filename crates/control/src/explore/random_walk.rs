//! Random sampling of orders, for state spaces too large to explore.
use super::Exploration;
use super::context::ExplorationContext;
use super::faults::FaultChoice;
use super::report::{ExceededBound, ExplorationReport, ExplorationVerdict};
use super::state::ProgramState;
use super::transition::Transition;

/// Index of a random draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawIndex {
    /// Number of the schedule, from 0.
    pub schedule: u64,
    /// Number of the step, from 1. 0 for the choice of faults.
    pub step: u64,
    /// Number of the draw within the step, from 0 to 7.
    pub attempt: u32,
}

/// Function that draws one of `0..n` uniformly, for n above 0. Equal indices and n give equal
/// draws.
pub type Choose<'a> = dyn FnMut(DrawIndex, u32) -> u32 + 'a;

/// Number of draws per step before all enabled transitions are listed.
const ATTEMPTS: u32 = 8;

/// Follows random schedules from start to end. All enabled transitions are equally likely.
pub(super) fn sample(
    exploration: &Exploration<'_>,
    schedules: u64,
    choose: &mut Choose<'_>,
) -> ExplorationReport {
    let mut report = ExplorationReport::empty(ExplorationVerdict::Sampled);
    let choices = exploration
        .faults
        .choices(exploration.tables, exploration.expected);
    for schedule in 0..schedules {
        let mut choose = |step, attempt, n| {
            let draw = DrawIndex {
                schedule,
                step,
                attempt,
            };
            choose(draw, n)
        };
        let struck = &choices[choose(0, 0, choices.len() as u32) as usize];
        if let Some(verdict) = follow(exploration, struck, &mut choose, &mut report) {
            // Completed schedules count even if the work limit was reached in a later one.
            let enough =
                matches!(verdict, ExplorationVerdict::Unfinished(_)) && report.schedules > 0;
            if !enough {
                report.verdict = verdict;
            }
            break;
        }
        report.schedules += 1;
    }
    report
}

/// Follows one schedule. Returns a verdict if the schedule ends the sampling.
fn follow(
    exploration: &Exploration<'_>,
    struck: &FaultChoice,
    choose: &mut impl FnMut(u64, u32, u32) -> u32,
    report: &mut ExplorationReport,
) -> Option<ExplorationVerdict> {
    let context = ExplorationContext::new(exploration, struck);
    let checker = exploration.checker();
    let (mut state, effects) = ProgramState::first(&context);
    let mut made: Vec<Transition> = Vec::new();
    if let Some(wrong) = checker.effects(&effects) {
        return Some(checker.violated(&context, wrong, state.structure.phase(), &made));
    }
    loop {
        let step = made.len() as u64 + 1;
        let mut choose = |attempt, n| choose(step, attempt, n);
        let (transition, looked_at) = draw(&state, &context, &mut choose);
        report.work += looked_at;
        let Some(transition) = transition else { break };
        if report.work > exploration.bounds.work {
            return Some(ExplorationVerdict::Unfinished(ExceededBound::Work));
        }
        // Only the end of a phase or of an attempt is checked against the state before it.
        let ends = matches!(transition, Transition::EndPhase | Transition::Retry);
        let before = ends.then(|| state.clone());
        let phase = state.structure.phase();
        let effects = state.make(&context, transition);
        made.push(transition);
        report.transitions += 1;
        let wrong = match &before {
            Some(before) => checker.transition(before, transition, &effects),
            None => checker.effects(&effects),
        };
        let wrong = wrong.or_else(|| checker.unplanned(&context, &state));
        if let Some(wrong) = wrong {
            return Some(checker.violated(&context, wrong, phase, &made));
        }
    }
    let wrong = checker.hang(&state, &[])?;
    if exploration.hangs_allowed {
        report.hangs += 1;
        return None;
    }
    Some(checker.violated(&context, wrong, state.structure.phase(), &made))
}

/// Draws one of the enabled transitions, all equally likely. Returns it with the number of
/// transitions examined.
fn draw(
    state: &ProgramState<'_>,
    context: &ExplorationContext<'_>,
    choose: &mut impl FnMut(u32, u32) -> u32,
) -> (Option<Transition>, u64) {
    let (transits, faces) = (state.in_transit.len(), state.lattice.active().len());
    let all = (transits + faces) as u32;
    let is_plain = context.faults.is_none() && context.reach.is_none() && !state.can_abort(context);
    // Most open faces and messages are enabled, so rejection sampling is cheaper than listing all.
    if is_plain && all > 0 && !state.structure.is_phase_reported() {
        for attempt in 0..ATTEMPTS {
            let i = choose(attempt, all) as usize;
            if let Some(&transit) = state.in_transit.get(i) {
                return (Some(Transition::Arrive(transit)), 1);
            }
            let block_face = state.lattice.active().iter().nth(i - transits);
            if let Some(&block_face) =
                block_face.filter(|block_face| state.lattice.target(**block_face).is_some())
            {
                // Reaching the i-th face has a small cost.
                return (Some(Transition::Capture(block_face)), 1 + i as u64 / 16);
            }
        }
    }
    let mut transitions = state.transitions(context);
    let count = transitions.len();
    // A block that has not answered until then is dead.
    let is_going = transitions.iter().any(Transition::is_certain);
    let drawn = is_going.then(|| transitions.swap_remove(choose(0, count as u32) as usize));
    (drawn, count as u64)
}
