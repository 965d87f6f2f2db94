//! Which runs are to be done.
use std::ops::Range;

use crate::{Manifest, Records};

/// A run that is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PendingRun {
    pub program: usize,
    pub run: u64,
}

/// Runs that are to be done.
pub(crate) struct PendingRuns<'a> {
    programs: u64,
    jobs: Range<u64>,
    /// Runs of which none is done again.
    kept: Option<&'a Records>,
    /// How many there are.
    pub left: u64,
}

impl<'a> PendingRuns<'a> {
    /// Those of these [`job`]s that are not `kept`, of which there are no others.
    pub fn all(
        manifest: &Manifest,
        jobs: Range<u64>,
        kept: Option<&'a Records>,
    ) -> PendingRuns<'a> {
        let done = kept.map_or(0, |kept| kept.len() as u64);
        PendingRuns {
            programs: manifest.programs.len() as u64,
            left: (jobs.end - jobs.start).saturating_sub(done),
            jobs,
            kept,
        }
    }

    /// Nobody says that they can all be counted, let alone kept.
    pub fn iter(self) -> impl Iterator<Item = PendingRun> + use<'a> {
        let jobs = self.jobs.map(move |number| job(number, self.programs));
        jobs.filter(move |job| !(self.kept).is_some_and(|it| it.contains(job.program, job.run)))
    }
}

/// The number of a [`job`]; `None`: no ensemble has so many.
pub(crate) fn number(program: usize, run: u64, programs: u64) -> Option<u64> {
    run.checked_mul(programs)?.checked_add(program as u64)
}

/// A job by its number: the first run of each program, then the second, and so on, so that a table compares the programs
/// fairly at any time.
pub(crate) fn job(number: u64, programs: u64) -> PendingRun {
    PendingRun {
        program: (number % programs) as usize,
        run: number / programs,
    }
}
