//! Runs of a candidate, and what the next one is expected to cost and to narrow.
use stochc_runtime::Settings;

use super::FIRST_LIMIT;
use crate::statistics::unseen_share_error;
use crate::trade::sample::{End, Measured};

/// The limit of ticks, as a multiple of the mean of the first runs.
const LIMIT: f64 = 20.0;

/// A setting and its runs.
#[derive(Clone, Debug)]
pub(super) struct CandidateRuns {
    pub(super) settings: Settings,
    /// Why it is not measured.
    pub(super) left_out: Option<String>,
    /// For each program.
    pub(super) program_runs: Vec<ProgramRuns>,
}

/// One program at one candidate.
#[derive(Clone, Debug, Default)]
pub(super) struct ProgramRuns {
    pub(super) started: u64,
    pub(super) runs: Vec<Measured>,
    /// Of the ticks of runs that did not fail: number, mean, sum of squared deviations (Welford).
    moments: (f64, f64, f64),
    wall: f64,
}

impl CandidateRuns {
    /// The program with the fewest runs, if these are fewer than `runs`.
    pub(super) fn lacking(&self, runs: u64) -> Option<usize> {
        let program_runs = self.program_runs.iter().enumerate();
        let (program, cell) = program_runs.min_by_key(|(_, cell)| cell.started)?;
        (cell.started < runs).then_some(program)
    }

    pub(super) fn under_way(&self) -> bool {
        self.program_runs
            .iter()
            .any(|cell| (cell.runs.len() as u64) < cell.started)
    }
}

impl ProgramRuns {
    pub(super) fn add(&mut self, run: Measured) {
        self.runs.push(run);
        self.wall += run.wall;
        if run.end != End::Failed {
            let (n, mean, squares) = &mut self.moments;
            *n += 1.0;
            let off = run.ticks as f64 - *mean;
            *mean += off / *n;
            *squares += off * (run.ticks as f64 - *mean);
        }
    }

    pub(super) fn cost(&self) -> Option<f64> {
        (!self.runs.is_empty()).then(|| self.wall / self.runs.len() as f64)
    }

    /// Variance of the times over their squared mean; where no run has completed, what chance may have hidden.
    pub(super) fn spread(&self) -> f64 {
        let (n, mean, squares) = self.moments;
        if n < 2.0 || mean <= 0.0 {
            return 0.0;
        }
        let is_completed = |run: &Measured| run.end == End::Completed;
        match self.runs.iter().any(is_completed) {
            true => squares / (n - 1.0) / (mean * mean),
            false => n * unseen_share_error(n as usize).powi(2),
        }
    }

    /// Ticks after which a run is given up, a number of two digits and zeros.
    pub(super) fn limit(&self) -> u64 {
        let (n, mean, _) = self.moments;
        if n == 0.0 {
            return FIRST_LIMIT;
        }
        let limit = (LIMIT * mean).max(1.0);
        let digit = 10f64.powi(limit.log10().floor() as i32 - 1).max(1.0);
        ((limit / digit).ceil() * digit) as u64
    }
}
