//! Result of a trade, the content of `trade.json`, tables and figures.
use serde::Serialize;
use stochc_runtime::Settings;

use super::convergence::{Convergence, Doubling};
use super::ranking::{Ranked, Verdict};
use crate::stamped_json::stamped_json;
use crate::statistics::Relative;
use stochc_results::Manifest;

/// Result of a trade: programs with many settings. Times are in ticks, costs in CPU time \[s\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trade {
    /// Limit of ticks per run. `None` if runs have no limit.
    pub max_ticks: Option<u64>,
    /// Programs that were run.
    pub programs: Vec<TradedProgram>,
    /// Candidate that the others are compared with. `None` if no candidate can serve as reference.
    pub reference: Option<Reference>,
    /// Results of each combination of settings, in the order of the sweep.
    pub candidates: Vec<CandidateResult>,
    /// Recommended settings, in a few sentences.
    pub advice: String,
}

/// Program of a trade.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TradedProgram {
    /// Name of the program, without settings.
    pub name: String,
    /// Length of a tick in the program's scene \[s\].
    pub tick: f64,
}

/// Candidate that all others are compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Index of the candidate.
    pub candidate: usize,
    /// Whether the mean times at the reference have converged, within 10 %. Undecided if the last
    /// doubling has right-censored runs.
    pub convergence: Convergence,
    /// Upper limit, over all programs, of the relative change of a mean by the last doubling.
    /// Derived from the intervals. `None` if the intervals give no limit.
    pub bound: Option<f64>,
    /// All doublings of the substeps up to the reference, in order.
    pub doublings: Vec<Doubling>,
}

/// Candidate with its results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CandidateResult {
    /// Name of the candidate in tables.
    pub name: String,
    /// Options of `simulate` that select these settings.
    pub options: String,
    /// All settings of the candidate.
    pub settings: Settings,
    /// CPU time of a run: the mean of the programs' medians \[s\]. `None` if some program has no
    /// runs.
    pub cost: Option<f64>,
    /// Cost divided by the cost of the reference.
    pub cost_ratio: Option<f64>,
    /// Bias of the program with the largest bias. `None` if the bias of some program is unknown.
    pub worst: Option<Relative>,
    /// Upper limit of the bias of all programs, derived from the intervals. `None` if the intervals
    /// give no limit, for example with right-censored runs.
    pub bound: Option<f64>,
    /// Whether the candidate is Pareto-optimal: no cheaper candidate has a smaller bound on its
    /// bias.
    pub front: bool,
    /// Whether the candidate significantly reverses the order of two programs.
    pub reversed: bool,
    /// Conclusion about the order of each pair of programs.
    pub ranking: Vec<Ranked>,
    /// Results of each program with these settings.
    pub programs: Vec<ProgramResult>,
}

/// Results of a program with some settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramResult {
    /// Number of finished runs, the sum of the next four fields.
    pub runs: usize,
    /// Number of runs that completed the structure.
    pub completed: usize,
    /// Number of runs that timed out in a phase.
    pub timed_out: usize,
    /// Number of runs that reached the limit of ticks. Their times are right-censored.
    pub censored: usize,
    /// Number of runs whose physics failed.
    pub failed: usize,
    /// Mean completion time \[ticks\]. The restricted mean if runs are right-censored.
    pub mean: Option<f64>,
    /// Half-width of the 95 % interval of the mean.
    pub half_width: Option<f64>,
    /// Horizon of the restricted mean. `None` if no run is right-censored.
    pub horizon: Option<f64>,
    /// Mean divided by the reference's mean, minus one. `None` if it is unknown.
    pub bias: Option<Relative>,
    /// Median CPU time of a run \[s\].
    pub cost: Option<f64>,
    /// CPU time of a tick \[s\].
    pub cost_of_tick: Option<f64>,
}

impl Trade {
    /// Returns the text of `trade.json`.
    pub fn to_json(&self, manifest: &Manifest) -> String {
        stamped_json(self, manifest)
    }

    /// Returns the number of a program's right-censored runs at the last two numbers of substeps.
    /// The last one is the reference.
    pub(crate) fn reference_runs_at_limit(&self, program: usize) -> usize {
        let own = self.reference_candidate();
        let own = own.map_or(0, |candidate| candidate.programs[program].censored);
        let doublings = self.reference.as_ref().map(|it| &it.doublings[..]);
        let last = doublings.and_then(<[Doubling]>::last);
        last.map_or(own, |last| last.censored[program])
    }

    /// Returns the candidate that serves as reference, if there is one.
    pub fn reference_candidate(&self) -> Option<&CandidateResult> {
        self.candidates.get(self.reference.as_ref()?.candidate)
    }
}

impl CandidateResult {
    /// Returns the pairs of programs whose order the candidate reverses.
    pub fn reversals(&self) -> impl Iterator<Item = &Ranked> {
        let reversed = |pair: &&Ranked| pair.verdict == Verdict::Reversed;
        self.ranking.iter().filter(reversed)
    }

    /// Returns whether the candidate leaves out a physical term.
    pub fn reduced(&self) -> bool {
        self.settings.reduction.is_some()
    }
}
