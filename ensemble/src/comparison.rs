//! The figures that compare programs: what `--format json` says, and tables draw.
use serde::Serialize;
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;

use super::pairwise::{Group, TimeUnit, Verdict, pairwise_tests};
use super::times::{completion_time, completion_times, phase_time};
use super::{Finished, Manifest, Program};
use crate::statistics::{Difference, KaplanMeier, Observation, Summary};

/// An ensemble in figures; times are in ticks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// One for each program, in the order of the manifest.
    pub programs: Vec<Column>,
    /// One for each pair of programs, in the same order; of a sweep, only for different programs at
    /// the same values.
    pub pairs: Vec<Pair>,
    /// The unit of their differences: ticks, or seconds where the programs differ in the length of a
    /// tick.
    pub unit: &'static str,
}

/// The figures of one program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Column {
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
    /// Runs that were stopped by the timeout of a phase: their times are censored.
    pub timed_out: u64,
    /// Runs that were stopped by the limit of ticks, `--max-ticks`: their times are censored as well.
    pub stopped: u64,
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
    /// Times that were cut short.
    pub censored: usize,
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
    /// The first's time to completion less the second's; `None`: too few runs, or no spread, to tell.
    pub difference: Option<Difference>,
}

impl Comparison {
    /// Draws up the figures of finished runs.
    pub fn of(manifest: &Manifest, finished: &[Finished]) -> Comparison {
        let records = |of: usize| {
            let of = finished.iter().filter(move |done| done.program == of);
            of.map(|done| &done.record).collect::<Vec<_>>()
        };
        let records: Vec<_> = (0..manifest.programs.len()).map(records).collect();
        let programs = manifest.programs.iter().zip(&records);
        let clock = TimeUnit::of(manifest.programs.iter());
        let sides: Vec<Group> = (programs.clone())
            .map(|(program, records)| Group {
                varied: &program.varied,
                runs: completion_times(records.iter().copied(), manifest.seed, clock.tick(program)),
            })
            .collect();
        let name = |i: usize| manifest.programs[i].name.clone();
        Comparison {
            programs: programs
                .map(|(program, records)| column(manifest, program, records))
                .collect(),
            pairs: pairwise_tests(&sides, |_, _| false)
                .into_iter()
                .map(|contrast| Pair {
                    first: name(contrast.first),
                    second: name(contrast.second),
                    difference: match contrast.verdict {
                        Verdict::Known(difference) => Some(difference),
                        Verdict::Same | Verdict::Unknown => None,
                    },
                })
                .collect(),
            unit: clock.unit(),
        }
    }
}

impl Time {
    /// Sums up times of which some may be cut short; `None`: there are none.
    pub fn of(observations: &[Observation]) -> Option<Time> {
        let completed: Vec<f64> = observations
            .iter()
            .filter(|o| o.completed)
            .map(|o| o.time)
            .collect();
        let summary = Summary::of(&completed);
        let censored = observations.len() - completed.len();
        if censored == 0 {
            let summary = summary?;
            return Some(Time {
                completed: summary.n,
                censored,
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
        let curve = KaplanMeier::of(observations)?;
        let mean = curve.restricted_mean(curve.last());
        Some(Time {
            completed: completed.len(),
            censored,
            mean: mean.mean,
            half_width: (completed.len() > 1).then(|| mean.half_width()),
            horizon: Some(mean.horizon),
            min: summary.map(|summary| summary.min),
            max: None,
            sd: None,
            median: curve.median(),
            cv: None,
        })
    }
}

fn column(manifest: &Manifest, program: &Program, records: &[&RunRecord]) -> Column {
    let completed = |record: &&&RunRecord| record.outcome == Outcome::Completed;
    let limited = |limit| {
        let by = |record: &&&RunRecord| matches!(record.outcome, Outcome::TimedOut { by, .. } if by == limit);
        records.iter().filter(by).count()
    };
    let blocks: Vec<f64> = records
        .iter()
        .filter(completed)
        .map(|record| record.blocks_used.into())
        .collect();
    let unplanned: Vec<f64> = records
        .iter()
        .filter(completed)
        .map(|record| record.unplanned as f64)
        .collect();
    let count = |runs: usize| runs as u64;
    let done = records.iter().filter(completed).count();
    let (late, stopped) = (limited(Limit::Timeout), limited(Limit::MaxTicks));
    // What is attached by hand takes no time.
    let phases = program.phases().iter().enumerate();
    let waited = |(i, _): &(usize, _)| !program.is_planted(PhaseId(*i as u32));
    let phases: Vec<_> = phases.filter(waited).collect();
    Column {
        name: program.name.clone(),
        tick: program.scene.tick,
        phases: phases.len(),
        captures: program.captures(),
        blocks_used: Summary::of(&blocks).map(|summary| summary.mean),
        unplanned: Summary::of(&unplanned)
            .map(|summary| summary.mean)
            .filter(|_| records.iter().any(|record| record.unplanned > 0)),
        runs: manifest.runs,
        finished: count(records.len()),
        completed: count(done),
        timed_out: count(late),
        stopped: count(stopped),
        failed: count(records.len() - done - late - stopped),
        time: Time::of(&times(records, completion_time)),
        phase_times: phases
            .into_iter()
            .map(|(i, phase)| PhaseTime {
                name: phase.name.clone(),
                number: i,
                time: Time::of(&times(records, |record| phase_time(record, i))),
            })
            .collect(),
    }
}

fn times(
    records: &[&RunRecord],
    of: impl Fn(&RunRecord) -> Option<Observation>,
) -> Vec<Observation> {
    records.iter().filter_map(|record| of(record)).collect()
}
