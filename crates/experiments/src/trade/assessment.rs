//! Comparison of each candidate with the reference, from the runs of a sweep over settings.
use stochc_runtime::Settings;

use super::advice::advice;
use super::candidates::{flags, refines, short};
use super::convergence::{CLOSE, Convergence, Doubling, at_limit, convergence};
use super::ranking::{Orders, Ranked, Verdict};
use super::result::{CandidateResult, ProgramResult, Reference, Trade, TradedProgram};
use super::sample::Sample;
use crate::statistics::{Observation, Relative, relative};
use crate::{Comparison, ComparisonTally, Time};
use stochc_results::ChosenSetting;
use stochc_results::{Finished, JournalError, Manifest, Records};

/// Accumulator of a trade. Runs must be added in the order of program and number.
#[derive(Debug)]
pub struct TradeTally<'a> {
    manifest: &'a Manifest,
    /// Combinations of settings in the sweep, without duplicates.
    settings: Vec<&'a [ChosenSetting]>,
    /// Programs, without duplicates. They do not contain the settings of their points.
    programs: Vec<TradedProgram>,
    /// For each combination of settings and each of `programs`, the index in the manifest. `None`
    /// if the program was not run with these settings.
    places: Vec<Vec<Option<usize>>>,
    /// Times and costs of each program of the manifest.
    samples: Vec<Sample>,
}

/// Combination of settings, with the results of each program.
struct Row<'a> {
    settings: Settings,
    samples: Vec<&'a Sample>,
}

impl<'a> TradeTally<'a> {
    /// Creates a trade without runs. Returns `None` if the manifest varies no settings.
    pub fn new(manifest: &'a Manifest) -> Option<TradeTally<'a>> {
        let mut tally = TradeTally {
            manifest,
            settings: Vec::new(),
            programs: Vec::new(),
            places: Vec::new(),
            samples: vec![Sample::default(); manifest.programs.len()],
        };
        for (number, program) in manifest.programs.iter().enumerate() {
            let (settings, name) = (&program.chosen[..], program.name_without_settings());
            let row = place(&mut tally.settings, |it| *it == settings, || settings);
            let column = place(
                &mut tally.programs,
                |it| it.name == name,
                || TradedProgram {
                    name: name.clone(),
                    tick: program.scene.tick,
                },
            );
            tally.places.resize(tally.settings.len(), Vec::new());
            let places = &mut tally.places[row];
            places.resize(places.len().max(column + 1), None);
            places[column] = Some(number);
        }
        for places in &mut tally.places {
            places.resize(tally.programs.len(), None);
        }
        (tally.settings.len() > 1).then_some(tally)
    }

    /// Adds a finished run.
    pub fn add(&mut self, done: &Finished) {
        self.samples[done.program].add(done);
    }

    /// Compares all candidates with the reference. `comparison` must be the comparison of the same
    /// runs.
    pub fn finish(self, comparison: &Comparison) -> Trade {
        let (manifest, none) = (self.manifest, Sample::default());
        let rows: Vec<Row> = (self.places.iter())
            .map(|places| {
                let sample = |place: &Option<usize>| place.map_or(&none, |it| &self.samples[it]);
                let first = places.iter().flatten().next();
                let settings = first.map(|&it| manifest.settings_of(&manifest.programs[it]));
                Row {
                    settings: Settings {
                        rates: Vec::new(),
                        ..settings.unwrap_or_default().into_owned()
                    },
                    samples: places.iter().map(sample).collect(),
                }
            })
            .collect();
        let names = |row: usize| -> Vec<Option<&str>> {
            let name = |place: &Option<usize>| Some(&*manifest.programs[(*place)?].name);
            self.places[row].iter().map(name).collect()
        };
        let (reference, orders) = (reference(&rows), Orders::new(comparison));
        let against = reference.as_ref().map(|it| it.candidate);
        let candidates = rows.iter().enumerate().map(|(i, row)| {
            let reference = against.filter(|&it| it != i).map(|it| &rows[it]);
            let ranking = against.map_or_else(Vec::new, |it| orders.rank(&names(it), &names(i)));
            candidate(row, reference, ranking)
        });
        let mut candidates: Vec<CandidateResult> = candidates.collect();
        let whole = against.and_then(|it| candidates[it].cost);
        for candidate in &mut candidates {
            candidate.cost_ratio = candidate.cost.zip(whole).map(|(cost, whole)| cost / whole);
        }
        draw_front(&mut candidates, against);
        let mut trade = Trade {
            max_ticks: manifest.settings.max_ticks,
            programs: self.programs,
            reference,
            candidates,
            advice: String::new(),
        };
        trade.advice = advice(&trade);
        trade
    }
}

impl Trade {
    /// Compares the settings of a sweep. Returns `None` if the manifest varies no settings.
    ///
    /// # Errors
    /// If the runs cannot be read again.
    pub fn from_runs(
        manifest: &Manifest,
        finished: &Records,
    ) -> Result<Option<Trade>, JournalError> {
        let Some(mut tally) = TradeTally::new(manifest) else {
            return Ok(None);
        };
        let mut comparison = ComparisonTally::new(manifest);
        finished.each(|done| {
            tally.add(done);
            comparison.add(done);
        })?;
        Ok(Some(tally.finish(&comparison.finish())))
    }
}

/// Returns the index of the first element that `is_it` accepts. If there is none, appends `new()`
/// and returns its index.
fn place<T>(list: &mut Vec<T>, is_it: impl Fn(&T) -> bool, new: impl FnOnce() -> T) -> usize {
    let place = list.iter().position(is_it).unwrap_or(list.len());
    if place == list.len() {
        list.push(new());
    }
    place
}

/// Returns the reference: the finest uniform settings with at least two completed runs of each
/// program.
fn reference(rows: &[Row]) -> Option<Reference> {
    let is_known = |&i: &usize| {
        let mut samples = rows[i].samples.iter();
        refines(&rows[i].settings) && samples.all(|it| it.outcomes.completed > 1)
    };
    let mut refined: Vec<usize> = (0..rows.len()).filter(is_known).collect();
    refined.sort_by_key(|&i| rows[i].settings.substeps);
    let candidate = *refined.last()?;
    let times = |i: usize| -> Vec<&[Observation]> {
        let samples = rows[i].samples.iter();
        samples.map(|sample| &sample.times[..]).collect()
    };
    let doubling = |pair: &[usize]| {
        let [from, to] = [pair[0], pair[1]].map(|i| (rows[i].settings.substeps, times(i)));
        Doubling::new((from.0, &from.1), (to.0, &to.1))
    };
    let doublings: Vec<Doubling> = refined.windows(2).map(doubling).collect();
    let programs: Vec<usize> = (0..rows[candidate].samples.len()).collect();
    let is_cut = doublings.last().is_some_and(Doubling::is_cut);
    Some(Reference {
        candidate,
        convergence: match convergence(&doublings, &programs, CLOSE) {
            // Beyond the limit of ticks, times are unknown, so convergence remains undecided.
            Convergence::Converged if is_cut => Convergence::Undecided,
            found => found,
        },
        bound: doublings.last().and_then(|last| last.bound(&programs)),
        doublings,
    })
}

fn candidate(row: &Row, reference: Option<&Row>, ranking: Vec<Ranked>) -> CandidateResult {
    let other = |program: usize| reference.map(|it| &it.samples[program].times[..]);
    let samples = || row.samples.iter().enumerate();
    let cells: Vec<ProgramResult> = samples().map(|(i, it)| cell(it, other(i))).collect();
    let costs: Option<Vec<f64>> = cells.iter().map(|cell| cell.cost).collect();
    let biases: Option<Vec<Relative>> = cells.iter().map(|cell| cell.bias).collect();
    let is_cut =
        samples().any(|(i, sample)| at_limit(&sample.times) + other(i).map_or(0, at_limit) > 0);
    CandidateResult {
        name: short(&row.settings),
        options: flags(&row.settings),
        settings: row.settings.clone(),
        cost: costs.map(|costs| costs.iter().sum::<f64>() / costs.len() as f64),
        cost_ratio: None,
        bound: biases.as_ref().filter(|_| !is_cut).and_then(|biases| {
            let mut bounds = biases.iter().map(Relative::bound);
            bounds.try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
        }),
        worst: biases.and_then(|biases| {
            let size = |bias: &Relative| bias.value.abs();
            let biases = biases.into_iter();
            biases.max_by(|a, b| size(a).total_cmp(&size(b)))
        }),
        front: false,
        reversed: ranking.iter().any(|pair| pair.verdict == Verdict::Reversed),
        ranking,
        programs: cells,
    }
}

fn cell(sample: &Sample, reference: Option<&[Observation]>) -> ProgramResult {
    let times = &sample.times[..];
    let time = Time::new(times);
    ProgramResult {
        runs: sample.outcomes.finished(),
        completed: sample.outcomes.completed,
        timed_out: sample.outcomes.timed_out,
        censored: sample.outcomes.censored,
        failed: sample.outcomes.failed(),
        mean: time.as_ref().map(|time| time.mean),
        half_width: time.as_ref().and_then(|time| time.half_width),
        horizon: time.as_ref().and_then(|time| time.horizon),
        bias: reference.and_then(|reference| relative(times, reference)),
        cost: sample.cost(),
        cost_of_tick: sample.cost_of_tick(),
    }
}

/// Marks the Pareto-optimal candidates. The bias of the reference counts as 0. The bias of every
/// other candidate counts as the bound of its interval.
fn draw_front(candidates: &mut [CandidateResult], reference: Option<usize>) {
    let bias = |i: usize, candidate: &CandidateResult| {
        if reference == Some(i) {
            Some(0.0)
        } else {
            candidate.bound
        }
    };
    let place = |(i, candidate): (usize, &CandidateResult)| {
        Some((candidate.cost?, bias(i, candidate)?)).filter(|_| !candidate.reversed)
    };
    let places: Vec<Option<(f64, f64)>> = candidates.iter().enumerate().map(place).collect();
    for (i, candidate) in candidates.iter_mut().enumerate() {
        let Some((cost, bias)) = places[i] else {
            continue;
        };
        let beaten = |other: &(f64, f64)| {
            other.0 <= cost && other.1 <= bias && (other.0 < cost || other.1 < bias)
        };
        candidate.front = !places.iter().flatten().any(beaten);
    }
}
