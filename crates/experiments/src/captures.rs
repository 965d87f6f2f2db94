//! How long each capture of a program was waited for, and what captured: over all runs that did not fail.
//!
//! A capture that was under way when its run ended counts as a censored wait. Tables and reports have
//! their figures from here alone.
use std::collections::BTreeMap;

use serde::Serialize;
use stochc_ir::Face;
use stochc_ir::record::{BondRecord, Origin, Outcome, RunRecord, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::Time;
use crate::statistics::{KaplanMeier, Mean, Observation, TimeSample, quantile};
use stochc_results::EnsembleProgram;

/// Which capture of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CaptureKey {
    /// The phase it belongs to.
    pub phase: PhaseId,
    /// The role that magnetizes a face.
    pub parent: RoleId,
    /// The role that is given.
    pub child: RoleId,
    /// Which face, in the structure's frame.
    pub face: Face,
    /// How often the same has been done before in the phase.
    pub repetition: u32,
}

/// Tells captures that a run or a program repeats in a phase from each other.
#[derive(Debug, Default)]
pub struct Repetitions(BTreeMap<CaptureKey, u32>);

impl Repetitions {
    /// The key of the next capture, in the order of the program or of the run.
    pub fn next(
        &mut self,
        phase: PhaseId,
        (parent, face, child): (RoleId, Face, RoleId),
    ) -> CaptureKey {
        let first = CaptureKey {
            phase,
            parent,
            child,
            face,
            repetition: 0,
        };
        let before = self.0.entry(first).or_default();
        let repetition = *before;
        *before += 1;
        CaptureKey {
            repetition,
            ..first
        }
    }
}

/// What many runs say of a capture.
#[derive(Clone, Debug)]
pub struct Waits {
    /// From the magnetizing of the face to the docking \[ticks\], or, censored, to the end of the run.
    pub time: Time,
    /// The tenth and the ninetieth percentile \[ticks\], of a Kaplan-Meier curve if waits are censored; `None`: too few ended.
    pub spread: Option<(f64, f64)>,
    /// Entries of blocks into the reach of the pull for each capture, on average; `None`: none was made, or nothing moved.
    pub entries: Option<f64>,
    /// Ticks from the captured block's last entry to its docking, on average.
    pub docking: Option<f64>,
    /// Entries per tick of waiting, censored waits included; `None`: nobody waited, or nothing moved.
    pub entry_rate: Option<f64>,
    /// Captures of blocks that had never been captured.
    pub free: usize,
    /// Captures of blocks that had been released before, by their last role.
    pub released: Vec<(RoleId, usize)>,
}

/// The waits for a capture while they are collected.
#[derive(Clone, Debug, Default)]
struct CaptureTally {
    times: TimeSample,
    entries: Mean,
    docking: Mean,
    /// Entries in all waits, also in those that led to nothing.
    all_entries: f64,
    free: usize,
    released: BTreeMap<RoleId, usize>,
}

impl CaptureTally {
    fn add(&mut self, bond: &BondRecord) {
        let wait = bond.docked.saturating_sub(bond.magnetized);
        self.times.push(Observation::completed(wait as f64));
        // Who is captured has come in, but where nothing moves.
        if bond.entries > 0 {
            self.entries.add(bond.entries.into());
            self.docking.add(bond.docking as f64);
        }
        self.all_entries += f64::from(bond.entries);
        match bond.origin {
            Origin::Free => self.free += 1,
            Origin::Released { role, .. } => *self.released.entry(role).or_default() += 1,
        }
    }

    fn add_censored(&mut self, wait: &WaitRecord, end: u64) {
        let cut = end.saturating_sub(wait.magnetized);
        self.times.push(Observation::censored(cut as f64));
        self.all_entries += f64::from(wait.entries);
    }

    fn sum_up(self) -> Option<Waits> {
        let all = self.times.to_vec();
        let is_known =
            self.entries.value().is_some() || !all.iter().any(|time| time.is_completed());
        let total: f64 = all.iter().map(|time| time.time).sum();
        Some(Waits {
            time: Time::new(&all)?,
            spread: spread(&all),
            entries: self.entries.value(),
            docking: self.docking.value(),
            entry_rate: (total > 0.0 && is_known).then(|| self.all_entries / total),
            free: self.free,
            released: self.released.into_iter().collect(),
        })
    }
}

/// The tenth and the ninetieth percentile of waits, some of which may be censored.
fn spread(waits: &[Observation]) -> Option<(f64, f64)> {
    if waits.iter().all(|wait| wait.is_completed()) {
        let ended: Vec<f64> = waits.iter().map(|wait| wait.time).collect();
        return quantile(&ended, 0.1).zip(quantile(&ended, 0.9));
    }
    let curve = KaplanMeier::new(waits)?;
    curve.quantile(0.1).zip(curve.quantile(0.9))
}

/// The waits for each capture while runs of one program are told, of which failed ones count nothing.
#[derive(Clone, Debug, Default)]
pub struct WaitsTally(BTreeMap<CaptureKey, CaptureTally>);

impl WaitsTally {
    /// Adds a run.
    pub fn add(&mut self, record: &RunRecord) {
        if matches!(record.outcome, Outcome::Failed { .. }) {
            return;
        }
        let mut done = Repetitions::default();
        for bond in &record.bonds {
            let key = done.next(bond.phase, (bond.parent, bond.face, bond.child));
            self.0.entry(key).or_default().add(bond);
        }
        for wait in &record.waiting {
            let key = done.next(wait.phase, (wait.parent, wait.face, wait.child));
            let tally = self.0.entry(key).or_default();
            tally.add_censored(wait, record.ticks);
        }
    }

    /// What they say.
    pub fn finish(self) -> BTreeMap<CaptureKey, Waits> {
        let waits = self.0.into_iter();
        waits
            .filter_map(|(key, tally)| Some((key, tally.sum_up()?)))
            .collect()
    }
}

/// A capture of a program, in all runs that did not fail; times are in ticks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaptureSummary {
    /// The phase's name.
    pub phase: String,
    /// The phase's index, from 0.
    pub phase_number: u32,
    /// The role that magnetized a face.
    pub parent: String,
    /// Which, in the structure's frame.
    pub face: Face,
    /// The role that was given.
    pub child: String,
    /// How often the program has done the same before in this phase.
    pub repetition: u32,
    /// From the magnetizing of the face to the docking; censored where the run ended before.
    pub wait: Time,
    /// Entries of blocks into the reach of the pull for each capture, on average; `None`: none was made.
    pub entries: Option<f64>,
    /// Ticks from the captured block's last entry to its docking, on average.
    pub docking: Option<f64>,
    /// Entries per tick of waiting, of all waits together; `None`: nobody waited.
    pub entry_rate: Option<f64>,
    /// How many captured blocks had held which role before, sorted by role; the others were free.
    pub released: Vec<(String, usize)>,
}

/// The captures of a program, sorted by phase and roles.
pub fn captures(program: &EnsembleProgram, tally: WaitsTally) -> Vec<CaptureSummary> {
    (tally.finish().into_iter())
        // What is attached by hand was not waited for.
        .filter(|(key, _)| !program.is_planted(key.phase))
        .map(|(key, waits)| CaptureSummary {
            phase: program.phase(key.phase).to_owned(),
            phase_number: key.phase.0,
            parent: program.role(key.parent).to_owned(),
            face: key.face,
            child: program.role(key.child).to_owned(),
            repetition: key.repetition,
            wait: waits.time,
            entries: waits.entries,
            docking: waits.docking,
            entry_rate: waits.entry_rate,
            released: (waits.released.into_iter())
                .map(|(role, n)| (program.role(role).to_owned(), n))
                .collect(),
        })
        .collect()
}

impl CaptureSummary {
    /// The capture as one names it: `grow: A.up -> B`.
    pub fn label(&self) -> String {
        let again = match self.repetition {
            0 => String::new(),
            n => format!(" ({})", n + 1),
        };
        format!(
            "{}: {}.{} -> {}{again}",
            self.phase,
            self.parent,
            self.face.word(),
            self.child
        )
    }
}
