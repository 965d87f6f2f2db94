//! What came of it: what `trade.json` holds, and everything else is drawn from.
use crate as ensemble;
use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_runtime::Settings;

use super::advice::advice;
use super::candidates::{flags, refines, short};
use super::convergence::{CLOSE, Convergence, Doubling, convergence};
use super::plan::Outcome;
use super::ranking::{Ranked, Verdict, rank};
use super::sample::{End, Sample};
use crate::statistics::{Distance, Observation, Relative, Runs, distance, relative};
use crate::{Manifest, Time};

/// Version of the layout of `trade.json`; another one is not read.
pub const FORMAT: u32 = 2;

/// The trade of some programs; times in ticks, costs in seconds of processor time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trade {
    /// [`FORMAT`].
    pub format: u32,
    /// Version of the `stochc` that measured.
    pub stochc: String,
    /// The seed of every draw, the same at every rung.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: usize,
    /// Runs of each program at each rung, where they were asked for.
    pub runs: Option<u64>,
    /// Time for all of it \[s\], where that was asked for.
    pub budget: Option<f64>,
    /// Whether it came to its end; `false`: it was interrupted.
    pub complete: bool,
    /// What was run.
    pub programs: Vec<Program>,
    /// What everything is held against.
    pub reference: Option<Reference>,
    /// One for each setting that was tried or could not be.
    pub rungs: Vec<Setting>,
    /// What to do, in a sentence or two.
    pub advice: String,
}

/// A program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// What tables call it.
    pub name: String,
    /// SHA-256 of its text, its imports and its scene, in hexadecimal.
    pub hash: String,
    /// Ticks after which its runs were given up.
    pub max_ticks: u64,
    /// The world it runs in.
    pub scene: Scene,
}

/// The rung that the others are held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Its index.
    pub rung: usize,
    /// Whether it has converged to within 10 %.
    pub convergence: Convergence,
    /// The largest change of a mean by the last doubling that its interval does not exclude; `None`:
    /// nothing is excluded.
    pub bound: Option<f64>,
    /// All doublings that lead to it.
    pub doublings: Vec<Doubling>,
}

/// A setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// As tables call it.
    pub name: String,
    /// As options of `simulate`.
    pub options: String,
    /// What was set.
    pub settings: Settings,
    /// Why nothing was measured.
    pub left_out: Option<String>,
    /// Of one run, the mean of the programs' medians \[s\]; `None`: not every program was run.
    pub cost: Option<f64>,
    /// The same as a multiple of the reference's.
    pub cost_ratio: Option<f64>,
    /// The bias that is largest, of all programs'; `None`: not every program has one.
    pub worst: Option<Relative>,
    /// The largest bias of any program that its interval does not exclude.
    pub bound: Option<f64>,
    /// No cheaper rung has a smaller bound.
    pub front: bool,
    /// It orders two programs the wrong way.
    pub reversed: bool,
    /// What it says to the order of each pair of programs.
    pub ranking: Vec<Ranked>,
    /// For each program.
    pub programs: Vec<Cell>,
}

/// A program at a setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Runs that have ended, the sum of the next three.
    pub runs: usize,
    /// Runs with the whole structure.
    pub completed: usize,
    /// Runs that were stopped before.
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
    /// Processor time of a tick \[s\].
    pub cost_of_tick: Option<f64>,
}

/// How it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The seed of every draw.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: usize,
    /// Runs of each program at each rung, where they were asked for.
    pub runs: Option<u64>,
    /// Time for all of it \[s\], where that was asked for.
    pub budget: Option<f64>,
    /// Whether it came to its end.
    pub complete: bool,
}

impl Trade {
    /// Draws it up; `limits` are the ticks after which runs of each program were given up.
    pub fn of(
        programs: &[ensemble::Program],
        outcomes: &[Outcome],
        limits: &[u64],
        means: Conditions,
    ) -> Trade {
        let times: Vec<Vec<Vec<Observation>>> = (outcomes.iter())
            .map(|outcome| outcome.samples.iter().map(Sample::times).collect())
            .collect();
        let runs: Vec<Vec<Runs>> = (outcomes.iter())
            .map(|outcome| {
                let samples = outcome.samples.iter();
                samples.map(|sample| sample.runs(means.seed)).collect()
            })
            .collect();
        let reference = reference(outcomes, &times);
        let against = reference.as_ref().map(|r| r.rung);
        let mut rungs: Vec<Setting> = (outcomes.iter().zip(&times).enumerate())
            .map(|(i, (outcome, own))| {
                let ranking = match against {
                    Some(r) if !outcome.samples.iter().all(Sample::is_empty) => {
                        rank(&runs[r], &runs[i])
                    }
                    _ => Vec::new(),
                };
                let reference = against.filter(|&r| r != i).map(|r| &times[r][..]);
                rung(outcome, own, reference, ranking)
            })
            .collect();
        let whole = against.and_then(|r| rungs[r].cost);
        for rung in &mut rungs {
            rung.cost_ratio = rung.cost.zip(whole).map(|(cost, whole)| cost / whole);
        }
        draw_front(&mut rungs, against);
        let described = programs
            .iter()
            .zip(limits)
            .map(|(program, &max_ticks)| Program {
                name: program.name.clone(),
                hash: program.hash(),
                max_ticks,
                scene: program.scene.clone(),
            });
        let mut trade = Trade {
            format: FORMAT,
            stochc: env!("CARGO_PKG_VERSION").to_owned(),
            seed: means.seed,
            threads: means.threads,
            runs: means.runs,
            budget: means.budget,
            complete: means.complete,
            programs: described.collect(),
            reference,
            rungs,
            advice: String::new(),
        };
        trade.advice = advice(&trade);
        trade
    }

    /// The text of `trade.json`, which ends in a line break.
    pub fn to_json(&self) -> String {
        let mut json = serde_json::to_string_pretty(self).expect("a trade is plain data");
        json.push('\n');
        json
    }

    /// Reads the text of a `trade.json`.
    ///
    /// # Errors
    /// In words, when it is none, or one of another [`FORMAT`] or version.
    pub fn from_json(json: &str) -> Result<Trade, String> {
        #[derive(Deserialize)]
        struct Version {
            format: u32,
            stochc: String,
            #[serde(rename = "rungs")]
            _rungs: serde::de::IgnoredAny,
        }
        let version: Version =
            serde_json::from_str(json).map_err(|_| "it is no trade that `stochc trade` wrote")?;
        if version.format != FORMAT {
            return Err(format!(
                "its format is {}, and this is {FORMAT}",
                version.format
            ));
        }
        let here = env!("CARGO_PKG_VERSION");
        if version.stochc != here {
            return Err(format!(
                "stochc {} has measured it, and this is {here}; measure again",
                version.stochc
            ));
        }
        let trade: Trade =
            serde_json::from_str(json).map_err(|error| format!("it is damaged, {error}"))?;
        let programs = trade.programs.len();
        let pairs = programs * programs.saturating_sub(1) / 2;
        let whole = |rung: &Setting| {
            rung.programs.len() == programs
                && (rung.ranking.is_empty() || rung.ranking.len() == pairs)
                && rung
                    .ranking
                    .iter()
                    .all(|pair| pair.first.max(pair.second) < programs)
        };
        let refers = trade.reference.as_ref().is_none_or(|reference| {
            reference.rung < trade.rungs.len()
                && reference
                    .doublings
                    .iter()
                    .all(|d| d.changes.len() == programs)
        });
        if !refers || !trade.rungs.iter().all(whole) {
            return Err("it is damaged: its parts do not belong together".into());
        }
        Ok(trade)
    }

    /// The rung that others are held against.
    pub fn reference_rung(&self) -> Option<&Setting> {
        self.rungs.get(self.reference.as_ref()?.rung)
    }
}

impl Setting {
    /// The pairs that it orders the wrong way.
    pub fn reversals(&self) -> impl Iterator<Item = &Ranked> {
        let reversed = |pair: &&Ranked| pair.verdict == Verdict::Reversed;
        self.ranking.iter().filter(reversed)
    }

    /// Whether something that the scene has is left out.
    pub fn reduced(&self) -> bool {
        self.settings.reduction.is_some()
    }
}

/// The finest rung that has at least two completed runs of each program.
fn reference(outcomes: &[Outcome], times: &[Vec<Vec<Observation>>]) -> Option<Reference> {
    let known = |i: &usize| {
        let enough = |times: &Vec<Observation>| times.iter().filter(|o| o.completed).count() > 1;
        refines(&outcomes[*i].settings) && times[*i].iter().all(enough)
    };
    let substeps = |i: usize| outcomes[i].settings.substeps;
    let mut rungs: Vec<usize> = (0..outcomes.len()).filter(known).collect();
    rungs.sort_by_key(|&i| substeps(i));
    let rung = *rungs.last()?;
    let doubling = |pair: &[usize]| {
        let [from, to] = [pair[0], pair[1]].map(|i| (substeps(i), &times[i][..]));
        Doubling::of(from, to)
    };
    let doublings: Vec<Doubling> = rungs.windows(2).map(doubling).collect();
    let programs: Vec<usize> = (0..times[rung].len()).collect();
    Some(Reference {
        rung,
        convergence: convergence(&doublings, &programs, CLOSE),
        bound: doublings.last().and_then(|last| last.bound(&programs)),
        doublings,
    })
}

fn rung(
    outcome: &Outcome,
    times: &[Vec<Observation>],
    reference: Option<&[Vec<Observation>]>,
    ranking: Vec<Ranked>,
) -> Setting {
    let cells: Vec<Cell> = (outcome.samples.iter().zip(times).enumerate())
        .map(|(i, (sample, own))| cell(sample, own, reference.map(|times| &times[i][..])))
        .collect();
    let costs: Option<Vec<f64>> = cells.iter().map(|cell| cell.cost).collect();
    let biases: Option<Vec<Relative>> = cells.iter().map(|cell| cell.bias).collect();
    let measured = outcome.samples.iter().any(|sample| !sample.is_empty());
    Setting {
        name: short(&outcome.settings),
        options: flags(&outcome.settings),
        settings: outcome.settings.clone(),
        left_out: match (&outcome.left_out, measured) {
            (Some(reason), _) => Some(reason.clone()),
            (None, true) => None,
            (None, false) => Some("there was no time for it".to_owned()),
        },
        cost: costs.map(|costs| costs.iter().sum::<f64>() / costs.len() as f64),
        cost_ratio: None,
        bound: biases.as_ref().and_then(|biases| {
            let mut bounds = biases.iter().map(Relative::bound);
            bounds.try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
        }),
        worst: biases.and_then(|biases| {
            let size = |bias: &Relative| bias.value.abs();
            biases
                .into_iter()
                .max_by(|a, b| size(a).total_cmp(&size(b)))
        }),
        front: false,
        reversed: ranking.iter().any(|pair| pair.verdict == Verdict::Reversed),
        ranking,
        programs: cells,
    }
}

fn cell(sample: &Sample, times: &[Observation], reference: Option<&[Observation]>) -> Cell {
    let time = Time::of(times);
    Cell {
        runs: sample.len(),
        completed: sample.count(End::Completed),
        censored: sample.count(End::Censored),
        failed: sample.count(End::Failed),
        mean: time.as_ref().map(|time| time.mean),
        half_width: time.as_ref().and_then(|time| time.half_width),
        horizon: time.as_ref().and_then(|time| time.horizon),
        bias: reference.and_then(|reference| relative(times, reference)),
        distance: reference.and_then(|reference| distance(times, reference)),
        cost: sample.cost(),
        cost_of_tick: sample.cost_of_tick(),
    }
}

/// Marks the rungs that no other one beats, the reference among them with no bias at all.
///
/// What counts of a bias is its bound, since of an interval's middle nothing follows.
fn draw_front(rungs: &mut [Setting], reference: Option<usize>) {
    let bias = |i: usize, rung: &Setting| match reference == Some(i) {
        true => Some(0.0),
        false => rung.bound,
    };
    let place = |(i, rung): (usize, &Setting)| {
        Some((rung.cost?, bias(i, rung)?)).filter(|_| !rung.reversed)
    };
    let places: Vec<Option<(f64, f64)>> = rungs.iter().enumerate().map(place).collect();
    for (i, rung) in rungs.iter_mut().enumerate() {
        let Some((cost, bias)) = places[i] else {
            continue;
        };
        let beaten = |other: &(f64, f64)| {
            other.0 <= cost && other.1 <= bias && (other.0 < cost || other.1 < bias)
        };
        rung.front = !places.iter().flatten().any(beaten);
    }
}

/// Which programs of an ensemble a trade knows, by their index in it.
///
/// # Errors
/// In words, when it does not know one of them as it is now.
pub fn known(trade: &Trade, manifest: &Manifest) -> Result<Vec<usize>, String> {
    let find = |program: &ensemble::Program| {
        let hash = program.hash();
        let known = trade.programs.iter().position(|known| known.hash == hash);
        known.ok_or_else(|| {
            format!(
                "it has not measured `{}` as it is now: the program or its scene is another one",
                program.name
            )
        })
    };
    manifest.programs.iter().map(find).collect()
}
