//! Hardware faults of a scene: dead blocks, and captures whose latch fails.
//!
//! All draws are pure functions of block and tick, so a run has no state for them.
use stochc_ir::scene::Faults;

use crate::counter_rng::{Draws, Stream, unit};

/// Step of the draws that apply to the whole run. The first capture is at tick 1.
const WHOLE_RUN: u64 = 0;

/// Random draws of hardware faults in one run.
#[derive(Debug)]
pub(super) struct HardwareFaults {
    dead: Option<f64>,
    latch: Option<f64>,
    draws: Draws,
}

impl HardwareFaults {
    pub fn new(faults: &Faults, seed: u64, run: u64) -> HardwareFaults {
        HardwareFaults {
            dead: faults.dead,
            latch: faults.latch,
            draws: Draws::new(seed, run, Stream::Fault),
        }
    }

    /// Returns whether a block is dead, from the start of the run to its end.
    pub fn is_dead(&mut self, body: u32) -> bool {
        self.dead
            .is_some_and(|dead| self.draw(WHOLE_RUN, body) < dead)
    }

    /// Returns whether the latch fails when a block is captured at a tick.
    pub fn latch_fails(&mut self, body: u32, tick: u64) -> bool {
        self.latch
            .is_some_and(|latch| self.draw(tick, body) < latch)
    }

    fn draw(&mut self, step: u64, body: u32) -> f64 {
        let [word, ..] = self.draws.step(step).block(body);
        unit(word)
    }
}
