//! Statistics of the waiting time and origin of each capture of a program, over all runs that did
//! not fail.
//!
//! A capture in progress at the end of its run counts as right-censored. Tables and reports all use
//! this module.
use std::collections::BTreeMap;

use serde::Serialize;
use stochc_ir::Face;
use stochc_ir::record::{BondRecord, Origin, RunRecord, WaitRecord};
use stochc_ir::table::{PhaseId, RoleId};

use super::Time;
use crate::statistics::{KaplanMeier, Mean, Observation, TimeSample, quantile};
use stochc_results::EnsembleProgram;

/// Identity of a capture in a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CaptureKey {
    /// Phase of the capture.
    pub phase: PhaseId,
    /// Role of the capturing block.
    pub parent: RoleId,
    /// Role of the captured block.
    pub child: RoleId,
    /// Face of the capturing block, in the structure's frame.
    pub face: Face,
    /// Number of earlier captures with the same blocks in the phase.
    pub repetition: u32,
}

impl CaptureKey {
    /// Returns the name of the capture, such as `grow: A.up -> B`.
    fn label(&self, program: &EnsembleProgram) -> String {
        let phase = program.phase(self.phase);
        let roles = (program.role(self.parent), program.role(self.child));
        label(phase, roles, self.face, self.repetition)
    }
}

fn label(phase: &str, roles: (&str, &str), face: Face, repetition: u32) -> String {
    let again = match repetition {
        0 => String::new(),
        n => format!(" ({})", n + 1),
    };
    let (parent, child) = roles;
    format!("{phase}: {parent}.{} -> {child}{again}", face.word())
}

/// Counter of repeated captures, which gives each capture in a phase its own key.
#[derive(Debug, Default)]
pub struct Repetitions(BTreeMap<CaptureKey, u32>);

impl Repetitions {
    /// Returns the key of the next capture. Captures must be passed in the order of the program or
    /// of the run.
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

/// Statistics of one capture of a program over many runs.
#[derive(Clone, Debug)]
pub struct Waits {
    /// Waiting time from switching the face on to the capture \[ticks\]. Right-censored at the end
    /// of the run.
    pub time: Time,
    /// 10th and 90th percentile of the waiting time \[ticks\], from a Kaplan-Meier curve if waiting
    /// times are censored. `None` if too few waits ended in a capture.
    pub spread: Option<(f64, f64)>,
    /// Mean number of times, per capture, that free blocks enter the reach of the pull. `None`
    /// without captures or motion.
    pub entries: Option<f64>,
    /// Mean time from the captured block's last entry into the reach of the pull to its capture
    /// \[ticks\].
    pub docking: Option<f64>,
    /// Number of entries into the reach of the pull per tick of waiting. Includes censored waiting
    /// times. `None` without waiting or motion.
    pub entry_rate: Option<f64>,
    /// Number of captured blocks that had never been captured before.
    pub free: usize,
    /// Number of captured blocks for each role that they had before their last release. Blocks that
    /// were never released are excluded.
    pub released: Vec<(RoleId, usize)>,
}

/// Accumulator for the statistics of one capture.
#[derive(Clone, Debug, Default)]
struct CaptureTally {
    times: TimeSample,
    entries: Mean,
    docking: Mean,
    /// Number of entries into the reach of the pull during all waiting times, including censored
    /// ones.
    all_entries: f64,
    free: usize,
    released: BTreeMap<RoleId, usize>,
}

impl CaptureTally {
    fn add(&mut self, bond: &BondRecord) {
        let wait = bond.docked.saturating_sub(bond.magnetized);
        self.times.push(Observation::completed(wait as f64));
        // Except in models without motion, a captured block has entered the reach at least once.
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

/// Returns the 10th and 90th percentile of waiting times, which may be censored.
fn spread(waits: &[Observation]) -> Option<(f64, f64)> {
    if waits.iter().all(|wait| wait.is_completed()) {
        let ended: Vec<f64> = waits.iter().map(|wait| wait.time).collect();
        return quantile(&ended, 0.1).zip(quantile(&ended, 0.9));
    }
    let curve = KaplanMeier::new(waits)?;
    curve.quantile(0.1).zip(curve.quantile(0.9))
}

/// Accumulator for the statistics of all captures of one program. Runs whose computation failed are
/// ignored.
#[derive(Clone, Debug, Default)]
pub struct WaitsTally(BTreeMap<CaptureKey, CaptureTally>);

impl WaitsTally {
    /// Adds the captures of a run.
    pub fn add(&mut self, record: &RunRecord) {
        if record.outcome.is_invalid() {
            return;
        }
        self.add_attempt(&record.bonds, &record.waiting, record.ticks);
        for abort in &record.aborts {
            self.add_attempt(&abort.bonds, &abort.waiting, abort.tick);
        }
    }

    /// Adds the captures up to the tick `end`. Each capture of the program happens at most once.
    fn add_attempt(&mut self, bonds: &[BondRecord], waiting: &[WaitRecord], end: u64) {
        let mut done = Repetitions::default();
        for bond in bonds {
            let key = done.next(bond.phase, (bond.parent, bond.face, bond.child));
            self.0.entry(key).or_default().add(bond);
        }
        for wait in waiting {
            let key = done.next(wait.phase, (wait.parent, wait.face, wait.child));
            let tally = self.0.entry(key).or_default();
            tally.add_censored(wait, end);
        }
    }

    /// Returns the waiting times \[ticks\] of each capture, with its name. Pre-attached blocks have
    /// none.
    pub fn times(&self, program: &EnsembleProgram) -> Vec<(String, Vec<Observation>)> {
        let captures = self.0.iter();
        captures
            .filter(|(key, _)| !program.is_pre_attached(key.phase))
            .map(|(key, tally)| (key.label(program), tally.times.to_vec()))
            .collect()
    }

    /// Returns the statistics of each capture.
    pub fn finish(self) -> BTreeMap<CaptureKey, Waits> {
        let waits = self.0.into_iter();
        waits
            .filter_map(|(key, tally)| Some((key, tally.sum_up()?)))
            .collect()
    }
}

/// Summary of a capture over all runs that did not fail. Times are in ticks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaptureSummary {
    /// Name of the phase.
    pub phase: String,
    /// Index of the phase, from 0.
    pub phase_number: u32,
    /// Role of the capturing block.
    pub parent: String,
    /// Capturing face, in the structure's frame.
    pub face: Face,
    /// Role of the captured block.
    pub child: String,
    /// Number of earlier captures with the same blocks in the phase.
    pub repetition: u32,
    /// Waiting time from switching the face on to the capture. Right-censored at the end of the
    /// run.
    pub wait: Time,
    /// Mean number of times, per capture, that free blocks enter the reach of the pull. `None`
    /// without captures.
    pub entries: Option<f64>,
    /// Mean time from the captured block's last entry into the reach of the pull to its capture
    /// \[ticks\].
    pub docking: Option<f64>,
    /// Number of entries into the reach of the pull per tick of waiting, over all waiting times.
    /// `None` without waiting.
    pub entry_rate: Option<f64>,
    /// Number of captured blocks for each role that they had before their release, sorted by role.
    /// All other captured blocks had never been captured before.
    pub released: Vec<(String, usize)>,
}

/// Returns a summary of each capture of a program, sorted by phase and roles.
pub fn captures(program: &EnsembleProgram, tally: WaitsTally) -> Vec<CaptureSummary> {
    (tally.finish().into_iter())
        // Pre-attached blocks have no waiting times.
        .filter(|(key, _)| !program.is_pre_attached(key.phase))
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
    /// Returns the name of the capture, such as `grow: A.up -> B`.
    pub fn label(&self) -> String {
        let roles = (&*self.parent, &*self.child);
        label(&self.phase, roles, self.face, self.repetition)
    }
}
