//! What came of it: what `trade.json` holds, and everything else is drawn from.
use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_runtime::Settings;

use super::convergence::{Convergence, Doubling};
use super::ranking::{Ranked, Verdict};
use crate::statistics::{Distance, Relative};

/// Version of the layout of `trade.json`.
pub const FORMAT: u32 = 1;

/// The trade of some programs; times in ticks, costs in seconds of processor time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trade {
    /// [`FORMAT`].
    pub format: u32,
    /// Version of the `stochc` that measured.
    pub stochc: String,
    /// The seed of every draw, the same at every candidate.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: usize,
    /// Runs of each program at each candidate, where they were asked for.
    pub runs: Option<u64>,
    /// Time for all of it \[s\], where that was asked for.
    pub budget: Option<f64>,
    /// Whether it came to its end; `false`: it was interrupted.
    pub complete: bool,
    /// What was run.
    pub programs: Vec<MeasuredProgram>,
    /// What everything is held against.
    pub reference: Option<Reference>,
    /// One for each setting that was tried or could not be.
    pub candidates: Vec<CandidateResult>,
    /// What to do, in a sentence or two.
    pub advice: String,
}

/// A program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredProgram {
    /// What tables call it.
    pub name: String,
    /// SHA-256 of its text, its imports and its scene, in hexadecimal.
    pub hash: String,
    /// Ticks after which its runs were given up.
    pub max_ticks: u64,
    /// The world it runs in.
    pub scene: Scene,
}

/// The candidate that the others are held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Its index.
    pub candidate: usize,
    /// Whether it has converged to within 10 %; where the limit of ticks has stopped runs of the last doubling, that is
    /// not known.
    pub convergence: Convergence,
    /// The largest change of a mean by the last doubling that its interval does not exclude; `None`:
    /// nothing is excluded.
    pub bound: Option<f64>,
    /// All doublings that lead to it.
    pub doublings: Vec<Doubling>,
}

/// A setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateResult {
    /// As tables call it.
    pub name: String,
    /// As options of `simulate`, or the command that gives it.
    pub options: String,
    /// What was set; `None`: it is an estimate, and makes no runs.
    pub settings: Option<Settings>,
    /// Why nothing was measured.
    pub left_out: Option<String>,
    /// Of one run, or of an estimate, the mean of the programs' medians \[s\]; `None`: not every program was run.
    pub cost: Option<f64>,
    /// The same as a multiple of the reference's.
    pub cost_ratio: Option<f64>,
    /// The bias that is largest, of all programs'; `None`: not every program has one.
    pub worst: Option<Relative>,
    /// The largest bias of any program that its interval does not exclude; `None`: any may be, as where the limit of
    /// ticks has stopped runs of it or of the reference.
    pub bound: Option<f64>,
    /// No cheaper candidate has a smaller bound.
    pub front: bool,
    /// It orders two programs the wrong way.
    pub reversed: bool,
    /// What it says to the order of each pair of programs.
    pub ranking: Vec<Ranked>,
    /// For each program.
    pub programs: Vec<ProgramResult>,
}

/// A program at a setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProgramResult {
    /// Runs that have ended, or times that were drawn, the sum of the next four.
    pub runs: usize,
    /// Runs with the whole structure.
    pub completed: usize,
    /// Runs that a timeout of the program has ended.
    pub timed_out: usize,
    /// Runs that reached the limit of ticks: their times are right-censored.
    pub censored: usize,
    /// Runs whose physics broke down.
    pub failed: usize,
    /// Mean time to completion \[ticks\]; where any are censored, of min(time, horizon).
    pub mean: Option<f64>,
    /// Half the width of its 95 % interval.
    pub half_width: Option<f64>,
    /// Where any are censored: up to here the mean counts.
    pub horizon: Option<f64>,
    /// The mean over the reference's, less one.
    pub bias: Option<Relative>,
    /// The whole distribution against the reference's.
    pub distance: Option<Distance>,
    /// Median processor time of a run \[s\].
    pub cost: Option<f64>,
    /// Processor time of a tick \[s\]; `None` as well for what has no ticks.
    pub cost_of_tick: Option<f64>,
}

impl Trade {
    /// The text of `trade.json`, which ends in a line break.
    pub fn to_json(&self) -> String {
        let mut json = serde_json::to_string_pretty(self).expect("a trade is plain data");
        json.push('\n');
        json
    }

    /// How many runs of a program the limit of ticks has stopped, among those of the reference and of its last doubling.
    pub(crate) fn reference_runs_at_limit(&self, program: usize) -> usize {
        let own = self.reference_candidate();
        let own = own.map_or(0, |candidate| candidate.programs[program].censored);
        let doublings = self.reference.as_ref().map(|it| &it.doublings[..]);
        let last = doublings.and_then(<[Doubling]>::last);
        last.map_or(own, |last| last.censored[program])
    }

    /// The candidate that others are held against.
    pub fn reference_candidate(&self) -> Option<&CandidateResult> {
        self.candidates.get(self.reference.as_ref()?.candidate)
    }
}

impl CandidateResult {
    /// The pairs that it orders the wrong way.
    pub fn reversals(&self) -> impl Iterator<Item = &Ranked> {
        let reversed = |pair: &&Ranked| pair.verdict == Verdict::Reversed;
        self.ranking.iter().filter(reversed)
    }

    /// Whether something that the scene has is left out.
    pub fn reduced(&self) -> bool {
        let settings = self.settings.as_ref();
        settings.is_some_and(|settings| settings.reduction.is_some())
    }
}
