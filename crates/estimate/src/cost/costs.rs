//! Estimated times of a program.
use stochc_ir::Draw;
use stochc_ir::graph::EventId;

use crate::{Interaction, LowerBoundReasons, Times};

/// Estimated cost of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// Completion time of the program. A sample with a timeout has an infinite time. `None` if
    /// there are no rates or too few free blocks. Also `None` if at least nine tenths of the
    /// samples have a timeout.
    pub total: Option<Times>,
    /// Whether rates were given.
    pub has_rates: bool,
    /// Sampled completion times, in random order. Empty if there are no times.
    pub draws: Vec<Draw>,
    /// Interaction between captures that the times neglect.
    pub interaction: Interaction,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
    /// Captures, sorted by decreasing share of the total time. Equal shares are in source order.
    /// Empty without times.
    pub captures: Vec<CaptureCost>,
}

impl Cost {
    /// Returns the number of samples with a timeout.
    pub fn stopped(&self) -> usize {
        self.draws.iter().filter(|draw| !draw.is_complete).count()
    }
}

/// Structure and duration of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseCost {
    /// Number of captures on the critical path.
    pub depth: u32,
    /// Largest number of simultaneously open faces if all captures take equally long.
    pub width: u32,
    /// Duration of the phase. `None` under the conditions of [`Cost::total`].
    pub times: Option<Times>,
    /// Share of the phase's samples that end at its timeout.
    pub timed_out: f64,
    /// Share of the total time that the `wait` of the phase takes on critical paths.
    pub wait: f64,
}

/// Cost of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCost {
    /// The capture.
    pub event: EventId,
    /// Mean waiting time of the capturing face \[ticks\]. Includes captures of blocks that are
    /// released nearby.
    pub wait: f64,
    /// Share of the total time during which the critical path waits for this capture.
    pub share: f64,
}
