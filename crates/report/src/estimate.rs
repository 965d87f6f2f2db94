//! Estimate of a program's completion time by the rate model.
use serde::Serialize;
use stochc_experiments::statistics::{Observation, Summary};
use stochc_experiments::{completion_time, phase_time};
use stochc_ir::record::RunRecord;
use stochc_ir::table::PhaseId;
use stochc_results::EnsembleProgram;
use stochc_runtime::rates::{Interaction, LowerBoundReasons, RemainingTime, Times};

use crate::analysis::critical_path::{critical_path, moments};
use crate::analysis::decisive_events::DecisiveEvents;
use crate::analysis::events::Events;

/// Estimated times of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CompletionEstimate {
    /// Name of the program.
    pub program: String,
    /// Method of the estimate.
    pub method: Method,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
    /// Number of samples or runs that completed.
    pub completed: u64,
    /// Number of samples or runs that did not complete, because of a timeout or the limit of ticks.
    pub incomplete: u64,
    /// Completion times of the program. Incomplete samples count as slower than all others. `None`
    /// if fewer than a tenth completed or the scene has too few free blocks. Also `None` if a run
    /// was stopped before the end of the slowest completed run.
    pub total: Option<Times>,
    /// Times of each phase, except phases of pre-attached blocks.
    pub phases: Vec<PhaseEstimate>,
    /// Captures, releases and the `wait` of phases, each with its share of the completion time. The
    /// largest share is first.
    pub shares: Vec<Share>,
}

/// Method that makes an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Method {
    /// Addition of sampled waiting times along the dependency graph.
    Graph {
        /// Effect of waiting captures on each other. The addition ignores this effect.
        interaction: Interaction,
        /// Largest measured relative error of a mean time with this interaction. The reference is
        /// runs of the rate model with the same rates.
        error: f64,
        /// Whether the scene has no calibrated rates, so that the estimate is uncalibrated.
        is_first_guess: bool,
    },
    /// Runs of the rate model with calibrated rates.
    Runs,
}

/// Estimated times of a phase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhaseEstimate {
    /// Name of the phase.
    pub name: String,
    /// Durations of the phase in the samples that reached it \[ticks\]. `None` under the conditions
    /// of [`CompletionEstimate::total`], applied to this phase.
    pub times: Option<Times>,
}

/// Estimated remaining time of a run in progress.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RemainingEstimate {
    /// Name of the program.
    pub program: String,
    /// Number of the run.
    pub run: u64,
    /// Time since the start of the run \[ticks\].
    pub elapsed: u64,
    /// Number of captures and releases that have happened.
    pub happened: usize,
    /// Number of captures and releases of the program.
    pub events: usize,
    /// Remaining time. `None` if a capture has no free block left.
    pub remaining: Option<RemainingTime>,
    /// Whether the scene has no calibrated rates, so that the estimate is uncalibrated.
    pub is_first_guess: bool,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
}

/// Share of an event in the completion time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Event in the notation of the program, or `wait`.
    pub event: String,
    /// Name of the event's phase.
    pub phase: String,
    /// Fraction of the total time that critical paths spend waiting for this event.
    pub share: f64,
}

impl CompletionEstimate {
    /// Estimates the times of a program from records of its runs in the rate model. `lower_bound`
    /// is the result of [`EnsembleProgram::lower_bound`].
    pub fn from_runs(
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
            .filter(|(_, phase)| !phase.pre_attached);
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

/// Returns the statistics of times. Incomplete runs count as slower than all others. Returns `None`
/// if the statistics depend on their unknown times.
fn times(seen: &[Observation]) -> Option<Times> {
    let times: Vec<f64> = seen.iter().filter_map(|it| it.completed_time()).collect();
    let longest = times.iter().copied().fold(0.0, f64::max);
    let is_slower = |it: &Observation| it.is_completed() || it.at_risk_until() >= longest;
    let never = seen.len() - times.len();
    if !seen.iter().all(is_slower) {
        return None;
    }
    // By Student's t, as in a table of the same runs.
    let half_width = Summary::from_values(&times).and_then(|summary| summary.half_width);
    let times = Times::new(times, never)?;
    Some(Times {
        half_width: half_width.filter(|_| times.mean.is_some()),
        ..times
    })
}

/// Returns the share of the total time that the critical paths spend on each event. The largest
/// share is first. Events without a share are absent.
fn shares(program: &EnsembleProgram, records: &[&RunRecord]) -> Vec<Share> {
    let events = Events::new(program);
    let mut decisive = DecisiveEvents::new(&events);
    for record in records {
        let path = critical_path(&events, record, &moments(&events, record));
        decisive.add(record.ticks, &path);
    }
    let share = |event: String, phase: PhaseId, ticks: f64| Share {
        event,
        phase: program.phase(phase).to_owned(),
        share: ticks / decisive.total.max(1.0),
    };
    let of_events = (events.events.iter().zip(&decisive.spent))
        .map(|(event, ticks)| share(event.text(program), event.phase, *ticks));
    let of_waits = (0..).zip(&decisive.waits);
    let of_waits =
        of_waits.map(|(phase, wait)| share("wait".to_owned(), PhaseId(phase), wait.spent));
    let mut shares: Vec<Share> = (of_events.chain(of_waits))
        .filter(|it| it.share > 0.0)
        .collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}
