//! Free blocks, where many chains take them at the same time.
//!
//! How many others have been captured while a face waits depends on how its chain and the others fare, which only a whole drawing knows: the chain that ends
//! last has fewer free blocks than if all captures took equally long. So a drawing is corrected by the free blocks that it has itself, some times over.
use rand_chacha::ChaCha8Rng;
use stochc_rates::{Parameters, Rates, Wait};

use super::drawn_times::{DrawnTimes, exponential};
use super::phase_events::taken_by;
use super::steps::Step;
use super::waits::CaptureWait;
use crate::Program;
use crate::plan::EventId;

/// Times that a drawing is corrected: all that would follow change a mean by 0.1 % where two thirds of the blocks are taken, and by nothing where half of them are.
const CORRECTIONS: usize = 3;

/// Events of a phase beyond which all drawings take blocks alike, so that two corrections that begin with the drawing before are enough.
const MANY: usize = 5000;

/// The steps of a phase in a program whose free blocks are scarce.
pub struct ScarcePhase<'a> {
    steps: &'a [Step],
    waits: &'a [Option<CaptureWait>],
    parameters: &'a Parameters,
    /// Blocks that are free at the beginning of the program.
    count: f64,
    /// By how many blocks each step leaves fewer of them.
    taken: Vec<f64>,
    /// How many are taken when the phase begins.
    before: f64,
    /// When steps change how many are taken, from the beginning of the phase, and how many that are then: of the last drawing.
    course: Vec<(f64, f64)>,
}

/// The phases of a program; `None`: there are enough blocks.
pub fn scarce_phases<'a>(
    program: &Program,
    steps: &'a [Vec<Step>],
    waits: &'a [Option<CaptureWait>],
    rates: &'a Rates,
) -> Option<Vec<ScarcePhase<'a>>> {
    let is_scarce = waits.iter().flatten().any(|wait| wait.is_scarce);
    let scene = program.scene.as_ref().filter(|_| is_scarce)?;
    let taken = |step: &Step| match program.layout.cells[step.event as usize] {
        Some(_) => taken_by(program.plan.event(EventId(step.event)).kind) as f64,
        None => 0.0,
    };
    let mut before = 0.0;
    let phases = steps.iter().map(|steps| {
        let phase = ScarcePhase {
            steps,
            waits,
            parameters: &rates.parameters,
            count: f64::from(scene.free.count.max(1)),
            taken: steps.iter().map(taken).collect(),
            before,
            course: Vec::new(),
        };
        before += phase.taken.iter().sum::<f64>();
        phase
    });
    Some(phases.collect())
}

impl ScarcePhase<'_> {
    /// Draws when the events of the phase happen that began at a time.
    pub fn draw(&mut self, began: f64, times: &mut DrawnTimes, rng: &mut ChaCha8Rng) {
        let hazards: Vec<f64> = self.steps.iter().map(|_| exponential(rng)).collect();
        if self.steps.len() <= MANY {
            self.course.clear();
        }
        let corrections = match self.course.is_empty() {
            true => 0..=CORRECTIONS,
            false => 1..=2,
        };
        for correction in corrections {
            for (step, &hazard) in self.steps.iter().zip(&hazards) {
                let event = step.event as usize;
                let half = (times.ends[event] - times.starts[event]) / 2.0;
                let start = times.begin(step, began);
                times.ends[event] = start;
                if let Some(CaptureWait { wait, free, .. }) = &self.waits[event] {
                    let rate = match correction {
                        0 => wait.rate,
                        _ => {
                            // Of the correction before, or about as long as it will be.
                            let half = match half.is_finite() {
                                true => half,
                                false => (hazard / wait.rate + wait.docking) / 2.0,
                            };
                            let left = self.free_at(start + half - began);
                            let of_free = |part| self.parameters.of_free(part);
                            wait.rate * of_free(left) / of_free(*free)
                        }
                    };
                    times.ends[event] += Wait { rate, ..*wait }.time_of(hazard);
                }
            }
            self.follow(began, times);
        }
    }

    /// The part of the blocks that is free at a time from the beginning of the phase: one block at least, the one that is captured.
    fn free_at(&self, time: f64) -> f64 {
        let taken = match self.course.partition_point(|&(when, _)| when <= time) {
            0 => self.before,
            after => self.course[after - 1].1,
        };
        (1.0 - taken / self.count).max(1.0 / self.count)
    }

    /// Takes over how many blocks are taken when, from a drawing.
    fn follow(&mut self, began: f64, times: &DrawnTimes) {
        let changes = self.steps.iter().zip(&self.taken);
        let changes =
            changes.map(|(step, taken)| (times.ends[step.event as usize] - began, *taken));
        self.course.clear();
        self.course.extend(changes);
        self.course.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = self.before;
        for (_, taken) in &mut self.course {
            sum += *taken;
            *taken = sum;
        }
    }
}
