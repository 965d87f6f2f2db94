//! Some orders, drawn by chance, where there are too many to try them all.
use super::Exploration;
use super::faults::Doom;
use super::report::{Bound, Report, Verdict};
use super::state::{Setting, State};
use super::step::Step;
use crate::counter_rng::{Draws, Stream, below};

/// Follows schedules from beginning to end: each step is one of the possible ones, all equally
/// likely.
pub(super) fn sample(exploration: &Exploration<'_>, seed: u64, schedules: u64) -> Report {
    let mut report = Report::empty(Verdict::Sampled);
    let dooms = exploration
        .faults
        .dooms(exploration.tables, exploration.expected);
    for number in 0..schedules {
        let mut draws = Draws::new(seed, number, Stream::Schedule);
        let [choice, ..] = draws.step(0).block(0);
        let doom = &dooms[below(choice, dooms.len() as u32) as usize];
        if let Some(verdict) = follow(exploration, doom, &mut draws, &mut report) {
            // What was followed to its end counts, even if the work ran out in the next.
            let enough = matches!(verdict, Verdict::Unfinished(_)) && report.schedules > 0;
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
    doom: &Doom,
    draws: &mut Draws,
    report: &mut Report,
) -> Option<Verdict> {
    let setting = Setting::new(exploration, doom);
    let judge = exploration.judge();
    let (mut state, effects) = State::first(&setting);
    let mut made: Vec<Step> = Vec::new();
    if let Some(wrong) = judge.effects(&effects) {
        return Some(judge.violated(&setting, wrong, state.structure.phase(), &made));
    }
    loop {
        let mut step_draws = draws.step(made.len() as u64 + 1);
        let words = [0, 1].map(|block| step_draws.block(block)).concat();
        let (step, looked_at) = draw(&state, &setting, &words);
        report.work += looked_at;
        let Some(step) = step else { break };
        if report.work > exploration.bounds.work {
            return Some(Verdict::Unfinished(Bound::Work));
        }
        // Only the end of a phase is judged by the state before it.
        let before = (step == Step::EndPhase).then(|| state.clone());
        let phase = state.structure.phase();
        let effects = state.make(&setting, step);
        made.push(step);
        report.transitions += 1;
        let wrong = match &before {
            Some(before) => judge.step(before, step, &effects),
            None => judge.effects(&effects),
        };
        let wrong = wrong.or_else(|| judge.unplanned(&setting, &state));
        if let Some(wrong) = wrong {
            return Some(judge.violated(&setting, wrong, phase, &made));
        }
    }
    let wrong = judge.hang(&state)?;
    if exploration.hangs_allowed {
        report.hangs += 1;
        return None;
    }
    Some(judge.violated(&setting, wrong, state.structure.phase(), &made))
}

/// One of the possible steps, each as likely as another, and how many were looked at.
fn draw(state: &State<'_>, setting: &Setting<'_>, words: &[u32]) -> (Option<Step>, u64) {
    let (flights, faces) = (state.under_way.len(), state.lattice.active().len());
    let all = (flights + faces) as u32;
    let is_plain = setting.faults.is_none() && setting.reach.is_none();
    // Most that is under way or on is possible: to draw until one is takes less than to list all.
    if is_plain && all > 0 && !state.structure.is_phase_reported() {
        for &word in words {
            let i = below(word, all) as usize;
            if let Some(&flight) = state.under_way.get(i) {
                return (Some(Step::Arrive(flight)), 1);
            }
            let site = state.lattice.active().iter().nth(i - flights);
            if let Some(&site) = site.filter(|site| state.lattice.target(**site).is_some()) {
                // Going to the i-th face is quick, but not for nothing.
                return (Some(Step::Capture(site)), 1 + i as u64 / 16);
            }
        }
    }
    let steps = state.steps(setting);
    let step = words
        .first()
        .and_then(|&word| steps.get(below(word, steps.len() as u32) as usize));
    (step.copied(), steps.len() as u64)
}
