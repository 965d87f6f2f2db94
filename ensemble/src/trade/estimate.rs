//! What is said of programs without a run, beside the settings that make runs.
use stochc_ir::Draw;

use super::sample::{End, Measured, Sample};
use crate::thread_time::thread_time;

/// What tables call it, and what gives it.
pub(super) const NAME: &str = "estimate";
pub(super) const COMMAND: &str = "stochc estimate";

/// Estimates of programs.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedSamples {
    /// Why there are none.
    pub left_out: Option<String>,
    /// The times that were drawn of each program, every one at the cost of all.
    pub samples: Vec<Sample>,
}

impl EstimatedSamples {
    /// None of so many programs, for a reason.
    pub fn none(programs: usize, reason: String) -> EstimatedSamples {
        EstimatedSamples {
            left_out: Some(reason),
            samples: vec![Sample::default(); programs],
        }
    }

    /// Of so many programs, each by what `draw` says of it.
    ///
    /// # Errors
    /// Those of `draw`, as a reason why there is none.
    pub fn of(
        programs: usize,
        draw: impl Fn(usize) -> Result<Vec<Draw>, String>,
    ) -> EstimatedSamples {
        let samples = (0..programs).map(|program| {
            let cpu = thread_time();
            let draws = draw(program)?;
            Ok(sample(
                &draws,
                thread_time().saturating_sub(cpu).as_secs_f64(),
            ))
        });
        match samples.collect() {
            Ok(samples) => EstimatedSamples {
                left_out: None,
                samples,
            },
            Err(reason) => EstimatedSamples::none(programs, reason),
        }
    }
}

fn sample(draws: &[Draw], cost: f64) -> Sample {
    let measured = (0..).zip(draws).map(|(run, draw)| Measured {
        run,
        end: match draw.is_complete {
            true => End::Completed,
            false => End::TimedOut,
        },
        ticks: draw.ticks.round() as u64,
        cpu: cost,
        wall: cost,
    });
    Sample::new(measured.collect(), u64::MAX)
}
