//! The captures of a program in figures: how long each was waited for, and how much that mattered.
use stochc_experiments::{Repetitions, Time, Waits};
use stochc_ir::graph::EventAction;
use stochc_ir::table::{PhaseId, RoleId};

use super::decisive_events::DecisiveEvents;
use super::reported_program::ReportedProgram;

/// One capture of a program, over all runs that did not fail.
#[derive(Clone, Debug)]
pub(crate) struct ReportedCapture {
    /// Its number in the program's events.
    pub event: usize,
    pub phase: PhaseId,
    /// `M.up -> N`.
    pub text: String,
    /// Whether it depends on the capture before it in the list.
    pub follows: bool,
    /// What the runs say of it; `None`: none has ever waited for it.
    pub waits: Option<Waits>,
    /// Its part of the time of all runs together, on the critical paths; 0 to 1.
    pub share: Option<f64>,
    /// In how many runs it was on that path.
    pub decided: usize,
}

impl ReportedCapture {
    /// From the magnetizing of the face to the docking \[ticks\]; censored in a run that was
    /// stopped before.
    pub fn time(&self) -> Option<&Time> {
        Some(&self.waits.as_ref()?.time)
    }

    /// The tenth and the ninetieth percentile of the waits \[ticks\], of Kaplan and Meier where any are censored.
    pub fn spread(&self) -> Option<(f64, f64)> {
        self.waits.as_ref()?.spread
    }

    /// Entries of blocks into the reach of the pull for each capture, on average.
    pub fn entries(&self) -> Option<f64> {
        self.waits.as_ref()?.entries
    }

    /// Ticks from the captured block's last entry to its docking, on average.
    pub fn docking(&self) -> Option<f64> {
        self.waits.as_ref()?.docking
    }

    /// How many captured blocks had never been captured.
    pub fn free(&self) -> usize {
        self.waits.as_ref().map_or(0, |waits| waits.free)
    }

    /// How many had been released before, by their last role.
    pub fn released(&self) -> &[(RoleId, usize)] {
        self.waits.as_ref().map_or(&[], |waits| &waits.released)
    }
}

/// Every capture of a program, in the order of its events; what its runs have told of waits is not kept.
pub(crate) fn waits(subject: &mut ReportedProgram) -> Vec<ReportedCapture> {
    let DecisiveEvents {
        spent,
        decided,
        total,
    } = &subject.decisive;
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
        });
    }
    found
}
