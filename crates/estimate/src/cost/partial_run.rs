//! Run in progress, whose remaining time is estimated.
use stochc_ir::table::PhaseId;

use serde::Serialize;
use stochc_ir::Draw;

use crate::Wait;
use crate::waits::times::quantile_of_cases;

/// State of a run in progress.
#[derive(Clone, Debug, PartialEq)]
pub struct PartialRun {
    /// Current time \[ticks\].
    pub now: f64,
    /// Running phase.
    pub phase: PhaseId,
    /// Start of the running attempt at the phase \[ticks\].
    pub began: f64,
    /// Number of times that the phase may still begin again after a timeout.
    pub retries: u32,
    /// State of each event of the graph.
    pub events: Vec<EventState>,
}

/// State of an event in a run in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventState {
    /// The event has not happened, and no face is open for it.
    Pending,
    /// The face of the capture has been open since this tick.
    Open(f64),
    /// The event happened at this tick.
    Happened(f64),
}

/// Remaining time of a run in progress \[ticks\]. A quantile is `None` if it is infinite, because
/// samples have a timeout.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RemainingTime {
    /// Median.
    pub median: Option<f64>,
    /// Lower end of the 90 % prediction interval.
    pub low: Option<f64>,
    /// Upper end of the 90 % prediction interval.
    pub high: Option<f64>,
    /// Share of the samples with a timeout.
    pub timed_out: f64,
}

impl RemainingTime {
    /// Returns the quantiles of sampled completion times. `now` is the current time.
    pub(super) fn new(draws: &[Draw], now: f64) -> RemainingTime {
        let complete = draws.iter().filter(|draw| draw.is_complete);
        let mut times: Vec<f64> = complete.map(|draw| (draw.ticks - now).max(0.0)).collect();
        times.sort_unstable_by(f64::total_cmp);
        let never = draws.len() - times.len();
        let quantile = |q| quantile_of_cases(&times, never, q);
        RemainingTime {
            median: quantile(0.5),
            low: quantile(0.05),
            high: quantile(0.95),
            timed_out: never as f64 / draws.len().max(1) as f64,
        }
    }
}

impl PartialRun {
    /// Returns the tick of an event, or `None` if it has not happened.
    pub(super) fn happened(&self, event: u32) -> Option<f64> {
        match self.events.get(event as usize) {
            Some(EventState::Happened(tick)) => Some(*tick),
            _ => None,
        }
    }

    /// Returns the start of an event that has not happened \[ticks\]. `earliest` is the tick when
    /// it can start.
    pub(super) fn start(&self, event: u32, earliest: f64) -> f64 {
        match self.events.get(event as usize) {
            Some(EventState::Open(tick)) => *tick,
            _ => earliest.max(self.now),
        }
    }

    /// Returns the cumulative hazard that a face has survived. It has been open since `start`.
    pub(super) fn survived(&self, wait: Wait, start: f64) -> f64 {
        wait.cumulative_hazard((self.now - start).max(0.0))
    }
}
