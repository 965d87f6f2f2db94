//! The captures of a program in figures: how long each was waited for, and how much that mattered.
use stochc_ensemble as ensemble;
use stochc_ensemble::{Repetitions, Time, Waits};
use stochc_ir::graph::EventAction;
use stochc_ir::record::Outcome;
use stochc_ir::table::{PhaseId, RoleId};

use super::subject::Subject;

/// One capture of a program, over all runs that did not fail.
#[derive(Clone, Debug)]
pub(crate) struct Wait {
    /// Its number in the program's events.
    pub event: usize,
    pub phase: PhaseId,
    /// `M.up -> N`.
    pub text: String,
    /// Whether it depends on the capture before it in the list.
    pub follows: bool,
    /// What the runs say of it; `None`: none has ever waited for it.
    pub waits: Option<Waits>,
    /// Its part of the time of all runs together, on the chains that decided them; 0 to 1.
    pub share: Option<f64>,
    /// In how many runs it was a link of that chain.
    pub decided: usize,
}

impl Wait {
    /// From the magnetizing of the face to the docking \[ticks\]; censored in a run that was
    /// stopped before.
    pub fn time(&self) -> Option<&Time> {
        Some(&self.waits.as_ref()?.time)
    }

    /// The tenth and the ninetieth percentile of the waits that ended \[ticks\].
    pub fn spread(&self) -> Option<(f64, f64)> {
        self.waits.as_ref()?.spread
    }

    /// Entries of blocks into the reach of the pull for each capture, on average.
    pub fn entries(&self) -> Option<f64> {
        let entries = self.waits.as_ref()?.entries.as_ref()?;
        Some(entries.mean)
    }

    /// Ticks from the captured block's last entry to its docking, on average.
    pub fn docking(&self) -> Option<f64> {
        let docking = self.waits.as_ref()?.docking.as_ref()?;
        Some(docking.mean)
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

/// Every capture of a program, in the order of its events.
pub(crate) fn waits(subject: &Subject) -> Vec<Wait> {
    let runs = || {
        let runs = subject.runs.iter();
        runs.filter(|run| !matches!(run.record.outcome, Outcome::Failed { .. }))
    };
    let count = subject.events.events.len();
    let (mut spent, mut decided) = (vec![0.0; count], vec![0; count]);
    let mut total = 0.0;
    for run in runs() {
        total += run.record.ticks as f64;
        for link in &run.chain {
            if let Some(event) = link.event() {
                spent[event] += link.ticks() as f64;
                decided[event] += 1;
            }
        }
    }
    let mut known = ensemble::waits(runs().map(|run| &run.record));
    let mut done = Repetitions::default();
    let mut found: Vec<Wait> = Vec::new();
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
        found.push(Wait {
            event: number,
            phase: event.phase,
            text: event.text(subject.program),
            follows: (event.waits_for.iter()).any(|&(first, _)| Some(first) == before),
            waits: known.remove(&key),
            share: (total > 0.0).then(|| spent[number] / total),
            decided: decided[number],
        });
    }
    found
}
