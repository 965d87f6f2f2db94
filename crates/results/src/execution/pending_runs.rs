//! Runs of an ensemble that must still be made.
use std::ops::Range;

use crate::{Manifest, Records};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PendingRun {
    pub program: usize,
    pub run: u64,
}

/// Runs that must still be made.
pub(crate) struct PendingRuns<'a> {
    programs: u64,
    jobs: Range<u64>,
    /// Finished runs, which are skipped.
    existing: Option<&'a Records>,
    /// Number of runs that must still be made.
    pub left: u64,
}

impl<'a> PendingRuns<'a> {
    /// Returns all runs with job numbers in `jobs`, except the `existing` runs.
    pub fn all(
        manifest: &Manifest,
        jobs: Range<u64>,
        existing: Option<&'a Records>,
    ) -> PendingRuns<'a> {
        let done = existing.map_or(0, |existing| existing.len() as u64);
        PendingRuns {
            programs: manifest.programs.len() as u64,
            left: (jobs.end - jobs.start).saturating_sub(done),
            jobs,
            existing,
        }
    }

    /// Iterates over the runs without storing them, because their number can be very large.
    pub fn iter(self) -> impl Iterator<Item = PendingRun> + use<'a> {
        let jobs = self.jobs.map(move |number| job(number, self.programs));
        jobs.filter(move |job| !(self.existing).is_some_and(|it| it.contains(job.program, job.run)))
    }
}

/// Returns the job number of a run, or `None` on overflow. See [`job`].
pub(crate) fn number(program: usize, run: u64, programs: u64) -> Option<u64> {
    run.checked_mul(programs)?.checked_add(program as u64)
}

/// Returns the run with a job number. Consecutive jobs are the same run of successive programs.
/// Partial results therefore contain about equally many runs of each program.
pub(crate) fn job(number: u64, programs: u64) -> PendingRun {
    PendingRun {
        program: (number % programs) as usize,
        run: number / programs,
    }
}
