//! Some orders, drawn by chance, where there are too many to try them all.
use super::Exploration;
use super::context::ExplorationContext;
use super::faults::FaultChoice;
use super::report::{ExceededBound, ExplorationReport, ExplorationVerdict};
use super::state::ProgramState;
use super::transition::Transition;

/// Which draw it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawIndex {
    /// The number of the schedule, from 0.
    pub schedule: u64,
    /// Of which step in it, from 1; 0: of those whom faults strike.
    pub step: u64,
    /// Draws before it in the same step: at most 7.
    pub attempt: u32,
}

/// Draws one of `0..n`, evenly, for a number n above 0: always the same for the same draw and number.
pub type Choose<'a> = dyn FnMut(DrawIndex, u32) -> u32 + 'a;

/// Draws in each step before all that is possible is listed.
const ATTEMPTS: u32 = 8;

/// Follows schedules from beginning to end: each transition is one of the possible ones, all equally
/// likely.
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
            // What was followed to its end counts, even if the work ran out in the next.
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

/// Follows one schedule; says when that is the end.
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
        // Only the end of a phase is judged by the state before it.
        let before = (transition == Transition::EndPhase).then(|| state.clone());
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
    let wrong = checker.hang(&state)?;
    if exploration.hangs_allowed {
        report.hangs += 1;
        return None;
    }
    Some(checker.violated(&context, wrong, state.structure.phase(), &made))
}

/// One of the possible transitions, each as likely as another, and how many were looked at.
fn draw(
    state: &ProgramState<'_>,
    context: &ExplorationContext<'_>,
    choose: &mut impl FnMut(u32, u32) -> u32,
) -> (Option<Transition>, u64) {
    let (transits, faces) = (state.under_way.len(), state.lattice.active().len());
    let all = (transits + faces) as u32;
    let is_plain = context.faults.is_none() && context.reach.is_none();
    // Most that is under way or on is possible: to draw until one is takes less than to list all.
    if is_plain && all > 0 && !state.structure.is_phase_reported() {
        for attempt in 0..ATTEMPTS {
            let i = choose(attempt, all) as usize;
            if let Some(&transit) = state.under_way.get(i) {
                return (Some(Transition::Arrive(transit)), 1);
            }
            let site = state.lattice.active().iter().nth(i - transits);
            if let Some(&site) = site.filter(|site| state.lattice.target(**site).is_some()) {
                // Going to the i-th face is quick, but not for nothing.
                return (Some(Transition::Capture(site)), 1 + i as u64 / 16);
            }
        }
    }
    let mut transitions = state.transitions(context);
    let count = transitions.len();
    let drawn = (count > 0).then(|| transitions.swap_remove(choose(0, count as u32) as usize));
    (drawn, count as u64)
}
