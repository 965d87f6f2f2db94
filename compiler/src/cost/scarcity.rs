//! Free blocks, where many chains take them at the same time.
//!
//! How many others have been captured while a face waits depends on how its chain and the others fare, which only a whole drawing knows: the chain that ends
//! last has fewer free blocks than if all captures took equally long. So a drawing is corrected by the free blocks that it has itself, some times over.
use rand_chacha::ChaCha8Rng;
use stochc_rates::{Parameters, Rates, Wait};

use super::drawn_times::{DrawnTimes, exponential};
use super::steps::Step;
use super::waits::CaptureWait;
use crate::Program;
use crate::plan::{EventId, EventKind};

/// Times that a drawing is corrected: all that would follow change a mean by 0.1 % where two thirds of the blocks are taken, and by nothing where half of them are.
const CORRECTIONS: usize = 3;

/// Events of a phase beyond which all drawings take blocks alike, so that two corrections that begin with the drawing before are enough.
const MANY: usize = 5000;

/// When events change how many blocks are taken, from the beginning of a phase, and how many that are then.
pub type Course = Vec<(f64, f64)>;

/// What is known of the free blocks of a program that makes them scarce.
pub struct Scarcity<'a> {
    parameters: &'a Parameters,
    /// Blocks that are free at the beginning.
    count: f64,
    /// By how many blocks each event leaves fewer of them.
    taken: Vec<f64>,
}

impl<'a> Scarcity<'a> {
    /// `None`: there are enough of them.
    pub fn of(
        program: &Program,
        waits: &[Option<CaptureWait>],
        rates: &'a Rates,
    ) -> Option<Scarcity<'a>> {
        let is_scarce = waits.iter().flatten().any(|wait| wait.is_scarce);
        let scene = program.scene.as_ref().filter(|_| is_scarce)?;
        let events = (0..waits.len()).map(|event| {
            let is_known = program.layout.cells[event].is_some();
            match program.plan.event(EventId(event as u32)).kind {
                _ if !is_known => 0.0,
                EventKind::Release => -1.0,
                _ => 1.0,
            }
        });
        Some(Scarcity {
            parameters: &rates.parameters,
            count: f64::from(scene.free.count.max(1)),
            taken: events.collect(),
        })
    }

    /// How many blocks the events of a phase take.
    pub fn taken_by(&self, steps: &[Step]) -> f64 {
        let taken = steps.iter().map(|step| self.taken[step.event as usize]);
        taken.sum()
    }

    /// Draws when the events of a phase happen that began when so many blocks were taken; `course`: of the drawing before, and then of this one.
    pub fn draw(
        &self,
        steps: &[Step],
        waits: &[Option<CaptureWait>],
        (began, taken): (f64, f64),
        course: &mut Course,
        (times, rng): (&mut DrawnTimes, &mut ChaCha8Rng),
    ) {
        let hazards: Vec<f64> = steps.iter().map(|_| exponential(rng)).collect();
        if steps.len() <= MANY {
            course.clear();
        }
        let corrections = match course.is_empty() {
            true => 0..=CORRECTIONS,
            false => 1..=2,
        };
        for correction in corrections {
            for (step, &hazard) in steps.iter().zip(&hazards) {
                let event = step.event as usize;
                let known = Some((times.ends[event] - times.starts[event]) / 2.0);
                let start = times.begin(step, began);
                times.ends[event] = start;
                if let Some(CaptureWait { wait, free, .. }) = &waits[event] {
                    let rate = match correction {
                        0 => wait.rate,
                        _ => {
                            // Of the correction before, or about as long as it will be.
                            let half = known.filter(|half| half.is_finite());
                            let half = half.unwrap_or((hazard / wait.rate + wait.docking) / 2.0);
                            let middle = start + half - began;
                            let left = 1.0 - at(course, middle, taken) / self.count;
                            // There is one at least: the one that is captured.
                            let left = left.max(1.0 / self.count);
                            let of_free = |part| self.parameters.of_free(part);
                            wait.rate * of_free(left) / of_free(*free)
                        }
                    };
                    times.ends[event] += Wait { rate, ..*wait }.time_of(hazard);
                }
            }
            let changes = steps.iter().map(|step| step.event as usize);
            course.clear();
            course.extend(changes.map(|event| (times.ends[event] - began, self.taken[event])));
            course.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            let mut sum = taken;
            for (_, taken) in course.iter_mut() {
                sum += *taken;
                *taken = sum;
            }
        }
    }
}

/// How many blocks are taken at a time.
fn at(course: &[(f64, f64)], time: f64, at_first: f64) -> f64 {
    match course.partition_point(|&(when, _)| when <= time) {
        0 => at_first,
        after => course[after - 1].1,
    }
}
