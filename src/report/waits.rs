//! The captures of a program in figures: how long each was waited for, and how much that mattered.
use std::collections::BTreeMap;

use stochc_compiler::table::{PhaseId, RoleId};
use stochc_runtime::record::{Origin, Outcome};

use super::subject::Subject;
use crate::ensemble::Time;
use crate::statistics::{Observation, Summary, quantile};

/// One capture of a program, over all runs that did not fail.
#[derive(Clone, Debug)]
pub(super) struct Wait {
    /// Its number in the program's events.
    pub event: usize,
    pub phase: PhaseId,
    /// `M.up -> N`.
    pub text: String,
    /// Whether it depends on the capture before it in the list.
    pub follows: bool,
    /// From the magnetizing of the face to the docking \[ticks\]; censored in a run that was
    /// stopped before.
    pub time: Option<Time>,
    /// The tenth and the ninetieth percentile of the waits that ended \[ticks\].
    pub spread: Option<(f64, f64)>,
    /// Entries of blocks into the reach of the pull for each capture, on average.
    pub entries: Option<Summary>,
    /// Ticks from the captured block's last entry to its docking, on average.
    pub docking: Option<Summary>,
    /// Blocks that had never been captured.
    pub free: usize,
    /// Blocks that had been released before, by their last role.
    pub released: Vec<(RoleId, usize)>,
    /// Its part of the time of all runs together, on the chains that decided them; 0 to 1.
    pub share: Option<f64>,
    /// In how many runs it was a link of that chain.
    pub decided: usize,
}

/// Every capture of a program, in the order of its events.
pub(super) fn waits(subject: &Subject) -> Vec<Wait> {
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
    let ordered = subject.events.tables.is_some();
    let mut found: Vec<Wait> = Vec::new();
    for (number, event) in subject.events.events.iter().enumerate() {
        if !event.deed.is_capture() {
            continue;
        }
        let mut times = Vec::new();
        let (mut entries, mut docking) = (Vec::new(), Vec::new());
        let (mut free, mut released) = (0, BTreeMap::<RoleId, usize>::new());
        for run in runs() {
            let moment = run.moments[number];
            if let Some(bond) = moment.bond.map(|i| &run.record.bonds[i]) {
                let wait = bond.docked.saturating_sub(bond.magnetized);
                times.push(Observation::completed(wait as f64));
                entries.push(f64::from(bond.entries));
                docking.push(bond.docking as f64);
                match bond.origin {
                    Origin::Free => free += 1,
                    Origin::Released { role, .. } => *released.entry(role).or_default() += 1,
                }
            } else if let (Some(ready), true) = (moment.ready, ordered) {
                let cut = run.record.ticks.saturating_sub(ready);
                times.push(Observation::censored(cut as f64));
            }
        }
        let known: Vec<f64> = (times.iter().filter(|time| time.completed))
            .map(|time| time.time)
            .collect();
        let before = found.last().map(|wait| wait.event);
        found.push(Wait {
            event: number,
            phase: event.phase,
            text: event.deed.text(subject.program),
            follows: (event.waits_for.iter()).any(|&(first, _)| Some(first) == before),
            time: Time::of(&times),
            spread: quantile(&known, 0.1).zip(quantile(&known, 0.9)),
            entries: Summary::of(&entries),
            docking: Summary::of(&docking),
            free,
            released: released.into_iter().collect(),
            share: (ordered && total > 0.0).then(|| spent[number] / total),
            decided: decided[number],
        });
    }
    found
}
