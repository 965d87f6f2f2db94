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
    /// How many are taken when, of the last drawing.
    course: Course,
}

/// How many blocks are taken over time.
#[derive(Default)]
struct Course {
    /// The length of a part \[tick\].
    part: f64,
    /// At the ends of all parts, the beginning of the first included; between them evenly. Empty: nobody has said.
    taken: Vec<f64>,
}

/// Parts of a phase in which the number of free blocks is told.
const PARTS: usize = 1024;

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
            course: Course::default(),
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
            self.course.taken.clear();
        }
        let corrections = match self.course.taken.is_empty() {
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
                    times.ends[event] += Wait { rate, ..*wait }.about_time_of(hazard);
                }
            }
            self.follow(began, times);
        }
    }

    /// The part of the blocks that is free at a time from the beginning of the phase: one block at least, the one that is captured.
    fn free_at(&self, time: f64) -> f64 {
        (1.0 - self.course.taken_at(time) / self.count).max(1.0 / self.count)
    }

    /// Takes over how many blocks are taken when, from a drawing.
    fn follow(&mut self, began: f64, times: &DrawnTimes) {
        let when = |step: &Step| times.ends[step.event as usize] - began;
        let longest = self.steps.iter().map(when).fold(0.0, f64::max);
        let part = (longest / PARTS as f64).max(f64::MIN_POSITIVE);
        let Course { taken, .. } = &mut self.course;
        taken.clear();
        taken.resize(PARTS + 1, 0.0);
        taken[0] = self.before;
        for (step, of_step) in self.steps.iter().zip(&self.taken) {
            // What happens at once is over before the first part.
            let end = (when(step) / part).ceil() as usize;
            taken[end.min(PARTS)] += of_step;
        }
        let mut sum = 0.0;
        for taken in taken {
            sum += *taken;
            *taken = sum;
        }
        self.course.part = part;
    }
}

impl Course {
    /// How many are taken at a time.
    fn taken_at(&self, time: f64) -> f64 {
        let at = time / self.part;
        let number = (at as usize).min(PARTS - 1);
        let [from, to] = [number, number + 1].map(|end| self.taken[end]);
        from + (to - from) * (at - number as f64).min(1.0)
    }
}
