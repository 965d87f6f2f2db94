//! Comparison of programs, for JSON output and tables.
use serde::Serialize;
use stochc_ir::record::{FaultKind, Outcome};
use stochc_ir::table::PhaseId;

use crate::OutcomeCounts;
use crate::comparison::{ComparedProgram, PairwiseResult, TimeUnit, pairwise_tests};
use crate::comparison::{completion_time, phase_time};
use crate::statistics::{Difference, KaplanMeier, Mean, Observation, Runs, Summary, TimeSample};
use stochc_results::{EnsembleProgram, Finished, Manifest};

/// Results of an ensemble's programs, and of their comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Unit of the programs' times: ticks, unless converted by [`Comparison::in_seconds`].
    pub time_unit: &'static str,
    /// Results of each program, in the order of the manifest.
    pub programs: Vec<ProgramSummary>,
    /// Result for each pair of programs, in the order of the manifest. In a sweep, only different
    /// programs with equal values of the axes are compared.
    pub pairs: Vec<Pair>,
    /// Unit of the differences: ticks, or seconds if the programs have different ticks.
    pub unit: &'static str,
}

/// Results of one program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramSummary {
    /// Name of the program in the manifest.
    pub name: String,
    /// Length of a tick \[s\].
    pub tick: f64,
    /// Number of phases.
    pub phases: usize,
    /// Number of captures. Papers call it "total units involved".
    pub captures: u64,
    /// Mean number of distinct blocks that a completed run captures. `None` if no run completed.
    pub blocks_used: Option<f64>,
    /// Mean number of unplanned captures in completed runs. `None` if no run has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unplanned: Option<f64>,
    /// Number of runs with a docked dead block. `None` if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead: Option<u64>,
    /// Number of requested runs.
    pub runs: u64,
    /// Number of finished runs, the sum of the next four fields.
    pub finished: u64,
    /// Number of completed runs.
    pub completed: u64,
    /// Number of runs that timed out in a phase. A timeout is a competing event. They never
    /// complete, so their times are infinite.
    pub timed_out: u64,
    /// Number of runs that reached the tick limit, `--max-ticks`. Their times are right-censored.
    pub censored: u64,
    /// Number of failed runs. Only runs with a broken bond have times, which are infinite.
    pub failed: u64,
    /// Statistics of the completion time. `None` if no run has a time.
    pub time: Option<Time>,
    /// Statistics of the time of each phase, in order.
    pub phase_times: Vec<PhaseTime>,
}

/// Times of one phase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhaseTime {
    /// Name of the phase.
    pub name: String,
    /// Index of the phase, from 0. If there are pre-attached blocks, they form phase 0.
    pub number: usize,
    /// Duration of the phase in the runs that reached it. `None` if no run has reached it.
    pub time: Option<Time>,
}

/// Statistics of a completion time, in ticks except `cv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Time {
    /// Number of completed times.
    pub completed: usize,
    /// Number of incomplete times: timed out or right-censored.
    pub incomplete: usize,
    /// Mean time. If some times are incomplete, this is the mean of min(time, horizon), a lower
    /// bound of the mean.
    pub mean: f64,
    /// Half-width of the 95 % confidence interval of the mean. `None` for fewer than two completed
    /// times.
    pub half_width: Option<f64>,
    /// Horizon: times above this limit count as this limit in `mean`. `None` if all times are
    /// complete.
    pub horizon: Option<f64>,
    /// Shortest completed time.
    pub min: Option<f64>,
    /// Longest time. `None` if some times are incomplete.
    pub max: Option<f64>,
    /// Standard deviation. `None` if some times are incomplete.
    pub sd: Option<f64>,
    /// Median time, by the Kaplan-Meier estimator if some times are incomplete. `None` if fewer
    /// than half of the runs completed.
    pub median: Option<f64>,
    /// Coefficient of variation. `None` if some times are incomplete.
    pub cv: Option<f64>,
}

/// Comparison of two programs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// Name of the first program.
    pub first: String,
    /// Name of the second program.
    pub second: String,
    /// Mean completion time of the first program minus mean completion time of the second. `None`
    /// if it cannot be determined.
    pub difference: Option<Difference>,
    /// Result of the comparison, with the reason if the difference is unknown.
    #[serde(skip)]
    pub verdict: PairwiseResult,
}

impl Comparison {
    /// Computes the comparison of finished runs.
    pub fn new<'a>(
        manifest: &Manifest,
        finished: impl IntoIterator<Item = &'a Finished>,
    ) -> Comparison {
        let mut tally = ComparisonTally::new(manifest);
        finished.into_iter().for_each(|done| tally.add(done));
        tally.finish()
    }

    /// Returns the comparison with all times and differences in seconds.
    pub fn in_seconds(mut self) -> Comparison {
        let seconds = TimeUnit::Seconds.unit();
        if self.time_unit == seconds {
            return self;
        }
        // Differences are in ticks only if all ticks have the same length.
        let tick = self.programs.first().map_or(1.0, |program| program.tick);
        if self.unit != seconds {
            let differences = self.pairs.iter_mut().flat_map(Pair::differences);
            differences.for_each(|difference| difference.scale(tick));
        }
        for program in &mut self.programs {
            let phases = program.phase_times.iter_mut();
            let times = phases.filter_map(|phase| phase.time.as_mut());
            let times = times.chain(&mut program.time);
            times.for_each(|time| time.scale(program.tick));
        }
        self.time_unit = seconds;
        self.unit = seconds;
        self
    }

    /// Replaces the name of each program by the result of `label`.
    pub fn relabel(&mut self, label: impl Fn(&str) -> String) {
        let pairs = self.pairs.iter_mut();
        let names = pairs.flat_map(|pair| [&mut pair.first, &mut pair.second]);
        let programs = self.programs.iter_mut().map(|program| &mut program.name);
        names.chain(programs).for_each(|name| *name = label(name));
    }
}

impl Pair {
    fn differences(&mut self) -> impl Iterator<Item = &mut Difference> {
        let known = match &mut self.verdict {
            PairwiseResult::Known(difference) => Some(difference),
            _ => None,
        };
        self.difference.iter_mut().chain(known)
    }
}

/// Accumulator of a comparison. Runs must be added in the order of program and number. Uses a few
/// bytes per run.
#[derive(Debug)]
pub struct ComparisonTally<'a> {
    manifest: &'a Manifest,
    clock: TimeUnit,
    programs: Vec<ProgramTally>,
}

/// Accumulator for the results of one program.
#[derive(Clone, Debug, Default)]
struct ProgramTally {
    outcomes: OutcomeCounts,
    blocks: Mean,
    unplanned: Mean,
    is_any_unplanned: bool,
    dead: u64,
    /// Number of each run, and its time \[ticks\].
    times: Vec<(u64, Observation)>,
    phase_times: Vec<TimeSample>,
}

impl<'a> ComparisonTally<'a> {
    /// Returns a comparison without runs.
    pub fn new(manifest: &'a Manifest) -> ComparisonTally<'a> {
        let tally = |program: &EnsembleProgram| ProgramTally {
            phase_times: vec![TimeSample::default(); program.phases().len()],
            ..ProgramTally::default()
        };
        ComparisonTally {
            manifest,
            clock: TimeUnit::common(manifest.programs.iter()),
            programs: manifest.programs.iter().map(tally).collect(),
        }
    }

    /// Adds a finished run.
    pub fn add(&mut self, done: &Finished) {
        let (tally, record) = (&mut self.programs[done.program], &done.record);
        tally.outcomes.add(&record.outcome);
        tally.is_any_unplanned |= record.unplanned > 0;
        tally.dead += u64::from(record.faults_of(FaultKind::Dead) > 0);
        if record.outcome == Outcome::Completed {
            tally.blocks.add(record.blocks_used.into());
            tally.unplanned.add(record.unplanned as f64);
        }
        let time = completion_time(record);
        tally.times.extend(time.map(|time| (record.run, time)));
        for (phase, times) in tally.phase_times.iter_mut().enumerate() {
            if let Some(time) = phase_time(record, phase) {
                times.push(time);
            }
        }
    }

    /// Returns the comparison of the runs added so far.
    pub fn finish(self) -> Comparison {
        let manifest = self.manifest;
        let programs = || manifest.programs.iter().zip(&self.programs);
        let last = |(program, tally): (&EnsembleProgram, &ProgramTally)| {
            let last = last_seen(tally.times.iter().map(|&(_, time)| time));
            last * self.clock.tick(program)
        };
        let last = programs().map(last).fold(0.0, f64::max);
        let columns = programs().map(|(program, tally)| {
            let horizon = last / self.clock.tick(program);
            tally.column(manifest, program, horizon)
        });
        let columns = columns.collect();
        let programs = manifest.programs.iter().zip(self.programs);
        let sides: Vec<ComparedProgram> = programs
            .map(|(program, tally)| ComparedProgram {
                varied: &program.varied,
                chosen: &program.chosen,
                identity: Some(manifest.runs_identity(program)),
                runs: Runs::new(manifest.seed, tally.times, self.clock.tick(program)),
            })
            .collect();
        let name = |i: usize| manifest.programs[i].name.clone();
        Comparison {
            time_unit: TimeUnit::Ticks.unit(),
            programs: columns,
            pairs: pairwise_tests(&sides)
                .into_iter()
                .map(|contrast| Pair {
                    first: name(contrast.first),
                    second: name(contrast.second),
                    difference: match &contrast.verdict {
                        PairwiseResult::Known(difference) => Some(difference.clone()),
                        _ => None,
                    },
                    verdict: contrast.verdict,
                })
                .collect(),
            unit: self.clock.unit(),
        }
    }
}

/// Returns the latest observed time of all runs. Returns 0 without runs.
pub fn last_seen(observations: impl IntoIterator<Item = Observation>) -> f64 {
    let times = observations.into_iter().map(|observation| observation.time);
    times.fold(0.0, f64::max)
}

impl Time {
    /// Multiplies all values except `cv` by a factor, to convert their unit.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.mean *= factor;
        let others = [
            &mut self.half_width,
            &mut self.horizon,
            &mut self.min,
            &mut self.max,
            &mut self.sd,
            &mut self.median,
        ];
        others.into_iter().flatten().for_each(|it| *it *= factor);
    }

    /// Returns the statistics of times, which may be incomplete. Returns `None` if there are no
    /// times.
    pub fn new(observations: &[Observation]) -> Option<Time> {
        Time::beside(observations, 0.0)
    }

    /// Returns the statistics of times for a comparison with other samples. `horizon` is the
    /// [latest observation](last_seen) of all samples.
    pub fn beside(observations: &[Observation], horizon: f64) -> Option<Time> {
        let completed: Vec<f64> = observations
            .iter()
            .filter(|o| o.is_completed())
            .map(|o| o.time)
            .collect();
        let summary = Summary::from_values(&completed);
        let incomplete = observations.len() - completed.len();
        if incomplete == 0 {
            let summary = summary?;
            return Some(Time {
                completed: summary.n,
                incomplete,
                mean: summary.mean,
                half_width: summary.half_width,
                horizon: None,
                min: Some(summary.min),
                max: Some(summary.max),
                sd: summary.sd,
                median: Some(summary.median),
                cv: summary.cv(),
            });
        }
        let curve = KaplanMeier::new(observations)?;
        let horizon = curve.last().max(horizon);
        let mean = curve.restricted_mean(horizon);
        // The interval is of the same kind as for complete times. Otherwise, it would jump with the
        // first incomplete run.
        let spread = Summary::from_values(&curve.contributions(observations, horizon));
        Some(Time {
            completed: completed.len(),
            incomplete,
            mean: mean.mean,
            half_width: (spread.filter(|_| completed.len() > 1)).and_then(|it| it.half_width),
            horizon: Some(mean.horizon),
            min: summary.map(|summary| summary.min),
            max: None,
            sd: None,
            median: curve.median(),
            cv: None,
        })
    }
}

impl ProgramTally {
    fn column(
        &self,
        manifest: &Manifest,
        program: &EnsembleProgram,
        horizon: f64,
    ) -> ProgramSummary {
        let times: Vec<Observation> = self.times.iter().map(|&(_, time)| time).collect();
        let time = Time::beside(&times, horizon);
        drop(times);
        // Pre-attached blocks take no time.
        let phases = program.phases().iter().enumerate();
        let waited = |(i, _): &(usize, _)| !program.is_pre_attached(PhaseId(*i as u32));
        let phases: Vec<_> = phases.filter(waited).collect();
        ProgramSummary {
            name: program.name.clone(),
            tick: program.scene.tick,
            phases: phases.len(),
            captures: program.captures(),
            blocks_used: self.blocks.value(),
            unplanned: self.unplanned.value().filter(|_| self.is_any_unplanned),
            dead: Some(self.dead).filter(|dead| *dead > 0),
            runs: manifest.runs,
            finished: self.outcomes.finished() as u64,
            completed: self.outcomes.completed as u64,
            timed_out: self.outcomes.timed_out as u64,
            censored: self.outcomes.censored as u64,
            failed: self.outcomes.failed() as u64,
            time,
            phase_times: phases
                .into_iter()
                .map(|(i, phase)| PhaseTime {
                    name: phase.name.clone(),
                    number: i,
                    time: Time::new(&self.phase_times[i].to_vec()),
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a sample of five runs, with the last run stopped exactly at its completion. Mean and
    /// interval are unchanged.
    #[test]
    fn censoring_does_not_change_the_kind_of_interval() {
        let times = [310.0, 420.0, 500.0, 760.0, 980.0];
        let all = Time::new(&times.map(Observation::completed)).unwrap();
        let mut some = times.map(Observation::completed);
        some[4] = Observation::censored(980.0);
        let some = Time::new(&some).unwrap();
        assert!((some.mean - all.mean).abs() < 1e-9);
        let [half, known] = [some.half_width, all.half_width].map(Option::unwrap);
        assert!((half - known).abs() < 1e-9 * known, "{half} {known}");
    }
}
