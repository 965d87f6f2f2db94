//! The trade of some programs: the content of `trade.json`, tables and figures.
use serde::Serialize;
use stochc_runtime::Settings;

use super::convergence::{Convergence, Doubling};
use super::ranking::{Ranked, Verdict};
use crate::stamped_json::stamped_json;
use crate::statistics::Relative;
use stochc_results::Manifest;

/// Programs at many settings. Times are in ticks, costs in CPU time \[s\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trade {
    /// Ticks after which a run was stopped. `None` if runs were not stopped.
    pub max_ticks: Option<u64>,
    /// Programs that were run.
    pub programs: Vec<TradedProgram>,
    /// Setting that the others are compared with.
    pub reference: Option<Reference>,
    /// Settings, in the order of the sweep.
    pub candidates: Vec<CandidateResult>,
    /// Recommended setting, in a few sentences.
    pub advice: String,
}

/// A program of the trade.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TradedProgram {
    /// Name of the program, without settings.
    pub name: String,
    /// Length of a tick of its scene \[s\].
    pub tick: f64,
}

/// The candidate that all others are compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Index of the candidate.
    pub candidate: usize,
    /// Whether the reference has converged to within 10 %. It is undecided if the limit of ticks
    /// stopped runs of the last doubling.
    pub convergence: Convergence,
    /// The largest change of a mean by the last doubling that its interval does not exclude. `None`
    /// if nothing is excluded.
    pub bound: Option<f64>,
    /// All doublings that lead to the reference.
    pub doublings: Vec<Doubling>,
}

/// A setting with its results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CandidateResult {
    /// Name of the setting in tables.
    pub name: String,
    /// Options of `simulate` for the setting.
    pub options: String,
    /// The settings in full.
    pub settings: Settings,
    /// CPU time of a run: the mean of the programs' medians \[s\]. `None` if some program has no
    /// runs.
    pub cost: Option<f64>,
    /// Cost as a multiple of the reference's cost.
    pub cost_ratio: Option<f64>,
    /// The largest bias of any program. `None` if some program has no bias.
    pub worst: Option<Relative>,
    /// The largest bias of any program that its interval does not exclude. `None` if nothing is
    /// excluded, for example because the limit of ticks stopped runs.
    pub bound: Option<f64>,
    /// Whether the setting is Pareto-optimal: no cheaper one has a smaller bound.
    pub front: bool,
    /// Whether the setting reverses the order of two programs.
    pub reversed: bool,
    /// Conclusion of the setting about the order of each pair of programs.
    pub ranking: Vec<Ranked>,
    /// Results for each program.
    pub programs: Vec<ProgramResult>,
}

/// Results of a program at a setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramResult {
    /// Number of finished runs, the sum of the next four fields.
    pub runs: usize,
    /// Number of runs that completed the structure.
    pub completed: usize,
    /// Number of runs that a timeout of the program ended.
    pub timed_out: usize,
    /// Number of runs that reached the limit of ticks. Their times are right-censored.
    pub censored: usize,
    /// Number of runs with failed physics.
    pub failed: usize,
    /// Mean time to completion \[ticks\]. With censored runs it is the restricted mean.
    pub mean: Option<f64>,
    /// Half-width of the 95 % interval of the bias.
    pub half_width: Option<f64>,
    /// Horizon of the restricted mean, with censored runs only.
    pub horizon: Option<f64>,
    /// Ratio of the mean to the reference's mean, minus one.
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

    /// Returns the number of runs of a program that the limit of ticks stopped. Counts the runs of
    /// the reference and of its last doubling.
    pub(crate) fn reference_runs_at_limit(&self, program: usize) -> usize {
        let own = self.reference_candidate();
        let own = own.map_or(0, |candidate| candidate.programs[program].censored);
        let doublings = self.reference.as_ref().map(|it| &it.doublings[..]);
        let last = doublings.and_then(<[Doubling]>::last);
        last.map_or(own, |last| last.censored[program])
    }

    /// Returns the candidate that all others are compared with.
    pub fn reference_candidate(&self) -> Option<&CandidateResult> {
        self.candidates.get(self.reference.as_ref()?.candidate)
    }
}

impl CandidateResult {
    /// Returns the pairs whose order the setting reverses.
    pub fn reversals(&self) -> impl Iterator<Item = &Ranked> {
        let reversed = |pair: &&Ranked| pair.verdict == Verdict::Reversed;
        self.ranking.iter().filter(reversed)
    }

    /// Returns whether the setting leaves out a part of the physics.
    pub fn reduced(&self) -> bool {
        self.settings.reduction.is_some()
    }
}
