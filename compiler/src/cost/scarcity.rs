//! Free blocks, where many chains take them at the same time.
//!
//! With few blocks left all faces wait longer by the same factor, and how many are left depends on how all chains fare. So a drawing goes through
//! the events of a phase in the order in which they happen, and the waits pass by a clock of their own: it runs as fast as rates are over
//! those of the full gas.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_rates::{Parameters, Rates, Wait};

use super::drawn_times::{DrawnTimes, exponential};
use super::phase_events::taken_by;
use super::steps::Step;
use super::waits::CaptureWait;
use crate::Program;
use crate::plan::EventId;

/// The steps of a phase in a program whose free blocks are scarce.
pub struct ScarcePhase<'a> {
    steps: &'a [Step],
    /// What each would wait for if all blocks were free; `None`: nothing.
    waits: Vec<Option<Wait>>,
    parameters: &'a Parameters,
    /// Blocks that are free at the beginning of the program.
    count: f64,
    /// By how many blocks each step leaves fewer of them.
    taken: Vec<f64>,
    /// How many are taken when the phase begins.
    before: f64,
    /// The steps that wait for each.
    after: Vec<SmallVec<[u32; 2]>>,
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
        let parameters = &rates.parameters;
        let full = |step: &Step| {
            let CaptureWait { wait, free, .. } = waits[step.event as usize].as_ref()?;
            Some(Wait {
                rate: wait.rate / parameters.of_free(*free),
                ..*wait
            })
        };
        let phase = ScarcePhase {
            steps,
            waits: steps.iter().map(full).collect(),
            parameters,
            count: f64::from(scene.free.count.max(1)),
            taken: steps.iter().map(taken).collect(),
            before,
            after: after(steps),
        };
        before += phase.taken.iter().sum::<f64>();
        phase
    });
    Some(phases.collect())
}

/// For each step the numbers of those that wait for it.
fn after(steps: &[Step]) -> Vec<SmallVec<[u32; 2]>> {
    let numbers: FxHashMap<u32, usize> = (steps.iter().enumerate())
        .map(|(number, step)| (step.event, number))
        .collect();
    let mut after = vec![SmallVec::new(); steps.len()];
    for (number, step) in (0..).zip(steps) {
        for event in &step.before {
            if let Some(&first) = numbers.get(event) {
                after[first].push(number);
            }
        }
    }
    after
}

/// What happens to a step at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Moment {
    /// It can begin: a face opens, if it is a capture.
    Begin,
    /// It is over.
    End,
}

/// When something happens, as the bits of a time, which are in the order of times that are not negative.
type Due<T> = Reverse<(u64, T)>;

/// A drawing under way.
struct Course {
    /// \[tick\]
    now: f64,
    /// What the faces have waited through, in ticks of the full gas.
    waited: f64,
    /// How many blocks are taken, and how fast faces capture for that over how fast they would from the full gas.
    taken: f64,
    speed: f64,
    /// What happens at times that are known already, by numbers of steps.
    planned: BinaryHeap<Due<(Moment, u32)>>,
    /// When the block that will dock comes into reach of each open face, by [`Course::waited`].
    arrivals: BinaryHeap<Due<u32>>,
    /// For how many others each step still waits, and the hazard that it has to go through.
    missing: Vec<u32>,
    hazards: Vec<f64>,
}

impl ScarcePhase<'_> {
    /// Draws when the events of the phase happen that began at a time.
    pub fn draw(&mut self, began: f64, times: &mut DrawnTimes, rng: &mut ChaCha8Rng) {
        let mut course = Course {
            now: began,
            waited: 0.0,
            taken: self.before,
            speed: self.speed(self.before),
            planned: BinaryHeap::new(),
            arrivals: BinaryHeap::new(),
            missing: self
                .steps
                .iter()
                .map(|step| step.before.len() as u32)
                .collect(),
            hazards: self.steps.iter().map(|_| exponential(rng)).collect(),
        };
        for (number, step) in (0..).zip(self.steps) {
            if step.before.is_empty() {
                course.plan(times.begin(step, began), Moment::Begin, number);
            }
        }
        loop {
            let planned = (course.planned.peek()).map(|Reverse((bits, _))| f64::from_bits(*bits));
            let arrival = (course.arrivals.peek()).map(|Reverse((bits, _))| {
                let left = f64::from_bits(*bits) - course.waited;
                course.now + (left / course.speed).max(0.0)
            });
            match (planned, arrival) {
                (None, None) => break,
                (planned, Some(arrival)) if planned.is_none_or(|planned| arrival <= planned) => {
                    let Some(Reverse((waited, number))) = course.arrivals.pop() else {
                        break;
                    };
                    (course.now, course.waited) = (arrival, f64::from_bits(waited));
                    if let Some(full) = self.waits[number as usize] {
                        let wait = Wait {
                            rate: full.rate * course.speed,
                            ..full
                        };
                        let hazard = course.hazards[number as usize];
                        let docking = wait.about_time_of(hazard) - hazard / wait.rate;
                        course.plan(arrival + docking.max(0.0), Moment::End, number);
                    }
                }
                _ => {
                    let Some(Reverse((time, (moment, number)))) = course.planned.pop() else {
                        break;
                    };
                    let time = f64::from_bits(time);
                    course.waited += (time - course.now) * course.speed;
                    course.now = time;
                    match moment {
                        Moment::Begin => self.begin(number, began, times, &mut course),
                        Moment::End => self.end(number, began, times, &mut course),
                    }
                }
            }
        }
    }

    /// How fast faces capture over how fast they would from the full gas. One block at least is free, the one that is captured.
    fn speed(&self, taken: f64) -> f64 {
        let left = (1.0 - taken / self.count).max(1.0 / self.count);
        self.parameters.of_free(left)
    }

    /// A step can begin: a face opens, and what waits for no block is over at once.
    fn begin(&self, number: u32, began: f64, times: &mut DrawnTimes, course: &mut Course) {
        match self.waits[number as usize] {
            Some(full) => course.open(full, number),
            None => self.end(number, began, times, course),
        }
    }

    /// A step is over, and others can begin.
    fn end(&self, number: u32, began: f64, times: &mut DrawnTimes, course: &mut Course) {
        let number = number as usize;
        times.ends[self.steps[number].event as usize] = course.now;
        if self.taken[number] != 0.0 {
            course.taken += self.taken[number];
            course.speed = self.speed(course.taken);
        }
        for &next in &self.after[number] {
            let missing = &mut course.missing[next as usize];
            *missing -= 1;
            if *missing == 0 {
                let start = times.begin(&self.steps[next as usize], began);
                match self.waits[next as usize] {
                    Some(full) if start <= course.now => course.open(full, next),
                    _ => course.plan(start, Moment::Begin, next),
                }
            }
        }
    }
}

impl Course {
    fn plan(&mut self, time: f64, moment: Moment, number: u32) {
        let due = time.max(self.now).to_bits();
        self.planned.push(Reverse((due, (moment, number))));
    }

    /// Has a face wait for the block that will dock.
    fn open(&mut self, full: Wait, number: u32) {
        let due = self.waited + self.hazards[number as usize] / full.rate;
        self.arrivals.push(Reverse((due.to_bits(), number)));
    }
}
