//! Waiting times of a program's captures, and their share of the completion time.
use stochc_experiments::{Repetitions, Time, Waits};
use stochc_ir::graph::EventAction;
use stochc_ir::table::{PhaseId, RoleId};

use super::decisive_events::DecisiveEvents;
use super::reported_program::ReportedProgram;

/// Capture of a program, with its statistics over all runs that did not fail.
#[derive(Clone, Debug)]
pub(crate) struct ReportedCapture {
    /// Index of the capture in the events of the program.
    pub event: usize,
    pub phase: PhaseId,
    /// Capture in the notation of the program, such as `M.up -> N`.
    pub text: String,
    /// Whether the capture depends on the previous capture in the list.
    pub follows: bool,
    /// Statistics of its waiting times. `None` if no run waited for it.
    pub waits: Option<Waits>,
    /// Fraction of the total time of all runs that this capture spends on the critical paths.
    pub share: Option<f64>,
    /// Number of runs with the capture on the critical path.
    pub decided: usize,
    /// Mean time on the critical path in the slowest tenth of the runs, minus that in the fastest
    /// tenth \[ticks\]. `None` with few runs.
    pub slower: Option<f64>,
    /// Part of `slower` after the last entry of the captured block \[ticks\].
    pub slower_docking: Option<f64>,
    /// Slow run with the largest time of the capture on the critical path.
    pub run_to_watch: Option<u64>,
}

impl ReportedCapture {
    /// Returns the waiting time from switching the face on to the capture \[ticks\]. It is
    /// right-censored in a run that was stopped first.
    pub fn time(&self) -> Option<&Time> {
        Some(&self.waits.as_ref()?.time)
    }

    /// Returns the 10th and 90th percentile of the waiting times \[ticks\], from the Kaplan-Meier
    /// curve if they are censored.
    pub fn spread(&self) -> Option<(f64, f64)> {
        self.waits.as_ref()?.spread
    }

    /// Returns the mean number of times per capture that a block enters the capture range.
    pub fn entries(&self) -> Option<f64> {
        self.waits.as_ref()?.entries
    }

    /// Returns the mean time from the captured block's last entry to its capture \[ticks\].
    pub fn docking(&self) -> Option<f64> {
        self.waits.as_ref()?.docking
    }

    /// Returns the number of captured blocks that had never been captured before.
    pub fn free(&self) -> usize {
        self.waits.as_ref().map_or(0, |waits| waits.free)
    }

    /// Returns, for each former role, the number of captured blocks that had been released from it.
    pub fn released(&self) -> &[(RoleId, usize)] {
        self.waits.as_ref().map_or(&[], |waits| &waits.released)
    }
}

/// Returns the captures of a program in the order of events. Removes the collected waiting times
/// from `subject`.
pub(crate) fn waits(subject: &mut ReportedProgram) -> Vec<ReportedCapture> {
    let DecisiveEvents {
        spent,
        decided,
        total,
        ..
    } = &subject.decisive;
    let slow_runs = subject.slow_runs.as_ref();
    let mut known = std::mem::take(&mut subject.waits).finish();
    let mut done = Repetitions::default();
    let mut found: Vec<ReportedCapture> = Vec::new();
    for (number, event) in subject.events.events.iter().enumerate() {
        let EventAction::Capture {
            parent,
            face,
            child,
        } = event.action
        else {
            continue;
        };
        let key = done.next(event.phase, (parent, face, child));
        let before = found.last().map(|wait| wait.event);
        found.push(ReportedCapture {
            event: number,
            phase: event.phase,
            text: event.text(subject.program),
            follows: (event.waits_for.iter()).any(|&(first, _)| Some(first) == before),
            waits: known.remove(&key),
            share: (*total > 0.0).then(|| spent[number] / total),
            decided: decided[number],
            slower: slow_runs.map(|it| it.difference(number)),
            slower_docking: slow_runs.map(|it| it.docking(number)),
            run_to_watch: slow_runs.and_then(|it| it.run_to_watch(number)),
        });
    }
    found
}

/// Shortest duration of a phase (`wait`) that is on a critical path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReportedWait {
    pub phase: PhaseId,
    /// Fraction of the total time of all runs.
    pub share: f64,
    /// Number of runs with this `wait` on the critical path.
    pub decided: usize,
    /// Mean time on the critical path in the slowest tenth of the runs, minus that in the fastest
    /// tenth \[ticks\]. `None` with few runs.
    pub slower: Option<f64>,
}

/// Returns the `wait` of each phase that is on a critical path.
pub(crate) fn phase_waits(subject: &ReportedProgram) -> Vec<ReportedWait> {
    let waits = subject.decisive.waits.iter().enumerate();
    let waits = waits.filter(|(_, wait)| wait.decided > 0);
    let reported = waits.map(|(phase, wait)| ReportedWait {
        phase: PhaseId(phase as u32),
        share: wait.spent / subject.decisive.total.max(1.0),
        decided: wait.decided,
        slower: subject
            .slow_runs
            .as_ref()
            .map(|it| it.difference_of_wait(phase)),
    });
    reported.collect()
}
