//! When a program will be complete, from runs by rates.
use serde::Serialize;
use stochc_ensemble::statistics::quantile;
use stochc_ensemble::{EnsembleProgram, completion_time};
use stochc_ir::record::RunRecord;

use crate::analysis::critical_path::{chain, moments};
use crate::analysis::events::Events;

/// What is expected of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The program.
    pub program: String,
    /// Runs that completed; of others nothing is known but that they took longer.
    pub completed: u64,
    /// Runs that did not.
    pub stopped: u64,
    /// Of the whole program; `None`: less than half of the runs completed.
    pub total: Option<Times>,
    /// Of each phase that is not planted.
    pub phases: Vec<PhaseEstimate>,
    /// Captures and releases, with the part of the time that was waited for each and nothing else: the largest first.
    pub shares: Vec<Share>,
}

/// A time in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Its mean.
    pub mean: f64,
    /// Half of the 95 % interval of the mean, of chance alone.
    pub half_width: f64,
    /// A tenth of the runs takes less.
    pub p10: f64,
    /// Half of them takes less.
    pub median: f64,
    /// Nine tenths of them take less.
    pub p90: f64,
}

/// What is expected of a phase.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhaseEstimate {
    /// Its name.
    pub name: String,
    /// In ticks; `None`: too few runs got there.
    pub times: Option<Times>,
}

/// What an event decides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// As the program writes it.
    pub event: String,
    /// The part of the time of all runs that nothing but it was waited for.
    pub share: f64,
}

impl Times {
    fn of(values: &[f64]) -> Option<Times> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        Some(Times {
            mean,
            half_width: 1.96 * (squares / (count - 1.0).max(1.0) / count).sqrt(),
            p10: quantile(values, 0.1)?,
            median: quantile(values, 0.5)?,
            p90: quantile(values, 0.9)?,
        })
    }
}

impl Estimate {
    /// From the records of a program's runs by rates.
    pub fn of(program: &EnsembleProgram, records: &[&RunRecord]) -> Estimate {
        let times: Vec<f64> = (records.iter())
            .filter_map(|record| completion_time(record))
            .filter(|time| time.completed)
            .map(|time| time.time)
            .collect();
        let enough = |values: &[f64]| 2 * values.len() >= records.len();
        let phases = program
            .phases()
            .iter()
            .enumerate()
            .filter(|(_, phase)| !phase.planted);
        let phases = phases.map(|(number, phase)| {
            let ticks = records
                .iter()
                .filter_map(|record| record.phase_ticks.get(number));
            let ticks: Vec<f64> = ticks.map(|ticks| *ticks as f64).collect();
            PhaseEstimate {
                name: phase.name.clone(),
                times: enough(&ticks).then(|| Times::of(&ticks)).flatten(),
            }
        });
        Estimate {
            program: program.name.clone(),
            completed: times.len() as u64,
            stopped: (records.len() - times.len()) as u64,
            total: enough(&times).then(|| Times::of(&times)).flatten(),
            phases: phases.collect(),
            shares: shares(program, records),
        }
    }
}

/// Who was waited for along the critical paths.
fn shares(program: &EnsembleProgram, records: &[&RunRecord]) -> Vec<Share> {
    let events = Events::of(program);
    let mut ticks = vec![0_u64; events.events.len()];
    for record in records {
        for link in chain(&events, record, &moments(&events, record)) {
            if let Some(event) = link.event() {
                ticks[event] += link.ticks();
            }
        }
    }
    let all: u64 = records.iter().map(|record| record.ticks).sum();
    let mut shares: Vec<(u64, Share)> = (events.events.iter().zip(ticks))
        .filter(|(_, ticks)| *ticks > 0)
        .map(|(event, ticks)| {
            let share = ticks as f64 / all.max(1) as f64;
            let event = event.text(program);
            (ticks, Share { event, share })
        })
        .collect();
    shares.sort_by_key(|(ticks, _)| std::cmp::Reverse(*ticks));
    shares.into_iter().map(|(_, share)| share).collect()
}
