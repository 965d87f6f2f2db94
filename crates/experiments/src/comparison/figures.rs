//! The figures that compare programs: what `--json` says, and tables draw.
use serde::Serialize;
use stochc_ir::record::{Limit, Outcome};
use stochc_ir::table::PhaseId;

use crate::comparison::{ComparedProgram, PairwiseResult, TimeUnit, pairwise_tests};
use crate::comparison::{completion_time, phase_time};
use crate::statistics::{Difference, KaplanMeier, Mean, Observation, Runs, Summary, TimeSample};
use stochc_results::{EnsembleProgram, Finished, Manifest};

/// An ensemble in figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The unit of the programs' times: ticks, unless [`Comparison::in_seconds`] has converted them.
    pub time_unit: &'static str,
    /// One for each program, in the order of the manifest.
    pub programs: Vec<ProgramSummary>,
    /// One for each pair of programs, in the same order; of a sweep, only for different programs at
    /// the same values.
    pub pairs: Vec<Pair>,
    /// The unit of their differences: ticks, or seconds where the programs differ in the length of a
    /// tick.
    pub unit: &'static str,
}

/// The figures of one program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramSummary {
    /// The program's name in the manifest.
    pub name: String,
    /// Length of a tick \[s\].
    pub tick: f64,
    /// How many phases it has.
    pub phases: usize,
    /// How many captures it makes: the paper's "total units involved".
    pub captures: u64,
    /// How many different blocks a completed run captured, on average; `None`: none completed.
    pub blocks_used: Option<f64>,
    /// Mean of the blocks that docked where nobody expected them, in completed runs; `None`: none did in
    /// any run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unplanned: Option<f64>,
    /// Runs asked for.
    pub runs: u64,
    /// Runs finished, the sum of the next four.
    pub finished: u64,
    /// Runs that completed the structure.
    pub completed: u64,
    /// Runs that were stopped by the timeout of a phase (a competing event): they never complete, and their times are
    /// infinite.
    pub timed_out: u64,
    /// Runs that reached the limit of ticks, `--max-ticks`: their times are right-censored.
    pub censored: u64,
    /// Runs whose physics broke down: no time counts them.
    pub failed: u64,
    /// Of the whole run.
    pub time: Option<Time>,
    /// Of each phase, in their order; a phase nobody reached has none.
    pub phase_times: Vec<PhaseTime>,
}

/// The times of one phase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhaseTime {
    /// The phase's name.
    pub name: String,
    /// The phase's index, from 0; blocks that are attached by hand are a phase, the first one.
    pub number: usize,
    /// Of the runs that reached it.
    pub time: Option<Time>,
}

/// What is known of a time to completion; ticks, except for `cv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Time {
    /// Times that were completed.
    pub completed: usize,
    /// Times that were cut short: timed out or right-censored.
    pub incomplete: usize,
    /// The mean; where any are cut short the mean of min(time, horizon), which is a lower bound.
    pub mean: f64,
    /// Half the width of its 95 % confidence interval; `None`: fewer than two were completed.
    pub half_width: Option<f64>,
    /// Where any are cut short: up to here the mean counts.
    pub horizon: Option<f64>,
    /// The shortest that was completed.
    pub min: Option<f64>,
    /// The longest; unknown where any are cut short.
    pub max: Option<f64>,
    /// Standard deviation; unknown where any are cut short.
    pub sd: Option<f64>,
    /// The median, of Kaplan and Meier where any are cut short; `None`: fewer than half completed.
    pub median: Option<f64>,
    /// Standard deviation / mean; unknown where any are cut short.
    pub cv: Option<f64>,
}

/// Two programs side by side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// Name of the first program.
    pub first: String,
    /// Name of the second.
    pub second: String,
    /// The first's time to completion less the second's; `None`: too few runs, or no spread, to tell, or nothing to
    /// compare.
    pub difference: Option<Difference>,
    /// The same, with the reason where there is none.
    #[serde(skip)]
    pub verdict: PairwiseResult,
}

impl Comparison {
    /// Draws up the figures of finished runs.
    pub fn new<'a>(
        manifest: &Manifest,
        finished: impl IntoIterator<Item = &'a Finished>,
    ) -> Comparison {
        let mut tally = ComparisonTally::new(manifest);
        finished.into_iter().for_each(|done| tally.add(done));
        tally.finish()
    }

    /// Converts all times and differences to seconds.
    pub fn in_seconds(mut self) -> Comparison {
        let seconds = TimeUnit::Seconds.unit();
        if self.time_unit == seconds {
            return self;
        }
        // Differences are in ticks only if the programs have ticks of one length.
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

    /// Gives each program the name that `label` returns for its own.
    pub fn relabel(&mut self, label: impl Fn(&str) -> String) {
        let pairs = self.pairs.iter_mut();
        let names = pairs.flat_map(|pair| [&mut pair.first, &mut pair.second]);
        let programs = self.programs.iter_mut().map(|program| &mut program.name);
        names.chain(programs).for_each(|name| *name = label(name));
    }
}

impl Pair {
    fn differences(&mut self) -> impl Iterator<Item = &mut Difference> {
        let told = match &mut self.verdict {
            PairwiseResult::Known(difference) => Some(difference),
            _ => None,
        };
        self.difference.iter_mut().chain(told)
    }
}

/// A comparison while runs are told, sorted by program and run: of each it keeps a few bytes for its times.
#[derive(Debug)]
pub struct ComparisonTally<'a> {
    manifest: &'a Manifest,
    clock: TimeUnit,
    programs: Vec<ProgramTally>,
}

/// What the runs of a program have told.
#[derive(Clone, Debug, Default)]
struct ProgramTally {
    finished: u64,
    completed: u64,
    timed_out: u64,
    censored: u64,
    blocks: Mean,
    unplanned: Mean,
    is_any_unplanned: bool,
    /// By their numbers, in ticks.
    times: Vec<(u64, Observation)>,
    phase_times: Vec<TimeSample>,
}

impl<'a> ComparisonTally<'a> {
    /// Before the first run.
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

    /// Adds a run.
    pub fn add(&mut self, done: &Finished) {
        let (tally, record) = (&mut self.programs[done.program], &done.record);
        tally.finished += 1;
        tally.is_any_unplanned |= record.unplanned > 0;
        match record.outcome {
            Outcome::Completed => {
                tally.completed += 1;
                tally.blocks.add(record.blocks_used.into());
                tally.unplanned.add(record.unplanned as f64);
            }
            Outcome::TimedOut { by, .. } => match by {
                Limit::Timeout => tally.timed_out += 1,
                Limit::MaxTicks => tally.censored += 1,
            },
            Outcome::Failed { .. } => {}
        }
        let time = completion_time(record);
        tally.times.extend(time.map(|time| (record.run, time)));
        for (phase, times) in tally.phase_times.iter_mut().enumerate() {
            if let Some(time) = phase_time(record, phase) {
                times.push(time);
            }
        }
    }

    /// The figures.
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

/// The last time that was seen of any run; 0 without runs.
pub fn last_seen(observations: impl IntoIterator<Item = Observation>) -> f64 {
    let times = observations.into_iter().map(|observation| observation.time);
    times.fold(0.0, f64::max)
}

impl Time {
    /// Multiplies all figures but `cv` by a factor, to convert their unit.
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

    /// Sums up times of which some may be cut short; `None`: there are none.
    pub fn new(observations: &[Observation]) -> Option<Time> {
        Time::beside(observations, 0.0)
    }

    /// The same beside other samples, of which the last time [seen](last_seen) is `horizon`: if runs never complete and none is censored,
    /// times count up to there. Who is stopped early would look fast otherwise.
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
        // As where all are known: an interval of another kind would jump with the first run that is stopped.
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
        // What is attached by hand takes no time.
        let phases = program.phases().iter().enumerate();
        let waited = |(i, _): &(usize, _)| !program.is_planted(PhaseId(*i as u32));
        let phases: Vec<_> = phases.filter(waited).collect();
        let known = self.completed + self.timed_out + self.censored;
        ProgramSummary {
            name: program.name.clone(),
            tick: program.scene.tick,
            phases: phases.len(),
            captures: program.captures(),
            blocks_used: self.blocks.value(),
            unplanned: self.unplanned.value().filter(|_| self.is_any_unplanned),
            runs: manifest.runs,
            finished: self.finished,
            completed: self.completed,
            timed_out: self.timed_out,
            censored: self.censored,
            failed: self.finished - known,
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

    /// The last of five is stopped where it would have completed: mean and interval stay as they are.
    #[test]
    fn an_interval_is_of_one_kind_whether_or_not_a_run_is_stopped() {
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
