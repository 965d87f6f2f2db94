//! When a program will be complete, by rates.
use serde::Serialize;
use stochc_experiments::statistics::{Observation, Summary};
use stochc_experiments::{completion_time, phase_time};
use stochc_ir::record::RunRecord;
use stochc_results::EnsembleProgram;
use stochc_runtime::rates::{Interaction, LowerBoundReasons, Times};

use crate::analysis::critical_path::{critical_path, moments};
use crate::analysis::events::Events;

/// What is expected of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CompletionEstimate {
    /// The program.
    pub program: String,
    /// What the times are from.
    pub method: Method,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
    /// Draws or runs that completed.
    pub completed: u64,
    /// Those that did not: a phase came to its timeout, or a run to its last tick.
    pub incomplete: u64,
    /// Of the whole program, those that did not complete being slower than all others; `None`: less than a tenth of them completed, or there
    /// is no block for a capture.
    pub total: Option<Times>,
    /// Of each phase that is not planted.
    pub phases: Vec<PhaseEstimate>,
    /// Captures and releases, with the part of the time that was waited for each and nothing else: the largest first.
    pub shares: Vec<Share>,
}

/// What times are from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Method {
    /// Waits, drawn and added up along the dependency graph.
    Graph {
        /// What that leaves out.
        interaction: Interaction,
        /// By how much means were off at most, beside runs by the same rates.
        error: f64,
        /// Whether nobody has measured the rates of the scene.
        is_first_guess: bool,
    },
    /// Runs by rates that were measured.
    Runs,
}

/// What is expected of a phase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhaseEstimate {
    /// Its name.
    pub name: String,
    /// In ticks, of those that came to it; `None`: too few of them got to its end, or a run came to its last tick in it sooner than
    /// others to its end.
    pub times: Option<Times>,
}

/// What an event decides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// As the program writes it.
    pub event: String,
    /// The phase that it is of.
    pub phase: String,
    /// The part of all time in which nothing but it was waited for.
    pub share: f64,
}

impl CompletionEstimate {
    /// From the records of a program's runs by rates.
    /// `lower_bound`: see [`EnsembleProgram::lower_bound`].
    pub fn of_runs(
        program: &EnsembleProgram,
        records: &[&RunRecord],
        lower_bound: LowerBoundReasons,
    ) -> CompletionEstimate {
        let seen = records.iter().filter_map(|record| completion_time(record));
        let seen: Vec<Observation> = seen.collect();
        let completed = seen.iter().filter(|it| it.is_completed()).count();
        let phases = program
            .phases()
            .iter()
            .enumerate()
            .filter(|(_, phase)| !phase.planted);
        let phases = phases.map(|(number, phase)| {
            let seen = records
                .iter()
                .filter_map(|record| phase_time(record, number));
            PhaseEstimate {
                name: phase.name.clone(),
                times: times(&seen.collect::<Vec<_>>()),
            }
        });
        CompletionEstimate {
            program: program.name.clone(),
            method: Method::Runs,
            lower_bound,
            completed: completed as u64,
            incomplete: (seen.len() - completed) as u64,
            total: times(&seen),
            phases: phases.collect(),
            shares: shares(program, records),
        }
    }
}

/// What observations come to, in which a run that did not complete is slower than all that did; `None` where that is not known.
fn times(seen: &[Observation]) -> Option<Times> {
    let times: Vec<f64> = seen.iter().filter_map(|it| it.completed_time()).collect();
    let longest = times.iter().copied().fold(0.0, f64::max);
    let is_slower = |it: &Observation| it.is_completed() || it.at_risk_until() >= longest;
    let never = seen.len() - times.len();
    if !seen.iter().all(is_slower) {
        return None;
    }
    // Student's interval, as that of a table of the same runs.
    let half_width = Summary::from_values(&times).and_then(|summary| summary.half_width);
    let times = Times::new(times, never)?;
    Some(Times {
        half_width: half_width.filter(|_| times.mean.is_some()),
        ..times
    })
}

/// Who was waited for along the critical paths.
fn shares(program: &EnsembleProgram, records: &[&RunRecord]) -> Vec<Share> {
    let events = Events::new(program);
    let mut ticks = vec![0.0; events.events.len()];
    for record in records {
        for segment in critical_path(&events, record, &moments(&events, record)) {
            if let Some(event) = segment.event() {
                ticks[event] += segment.ticks() as f64;
            }
        }
    }
    let all: f64 = records.iter().map(|record| record.ticks as f64).sum();
    let mut shares: Vec<(f64, Share)> = (events.events.iter().zip(ticks))
        .filter(|(_, ticks)| *ticks > 0.0)
        .map(|(event, ticks)| {
            let share = ticks / all.max(1.0);
            let phase = program.phases()[event.phase.0 as usize].name.clone();
            let event = event.text(program);
            (
                ticks,
                Share {
                    event,
                    phase,
                    share,
                },
            )
        })
        .collect();
    shares.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    shares.into_iter().map(|(_, share)| share).collect()
}
