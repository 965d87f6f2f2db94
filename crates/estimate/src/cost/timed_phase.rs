//! Simulates the events of a phase in the order of time.
//!
//! Three cases need this. Among open faces near a released block, the first one may capture it. If
//! free blocks are scarce, all chains compete for them. If several captures can free a magnet, the
//! first ones do.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::drawn_times::DrawnTimes;
use super::exponential::exponential;
use super::partial_run::PartialRun;
use super::scarcity::ScarceBlocks;
use super::steps::Step;
use super::waits::CaptureWait;
use crate::{ReleaseNearby, Wait};

/// Largest number of draws of a capture after `now`.
const MAX_DRAWS: usize = 100;

/// A phase to simulate in the order of time.
pub struct TimedPhase<'a> {
    steps: &'a [Step],
    waits: &'a [Option<CaptureWait>],
    /// For each step, the steps that wait for it, and whether they can wait for others instead.
    followers: Vec<SmallVec<[(u32, bool); 2]>>,
    /// For each release, the steps with a face that may capture the released block.
    near: FxHashMap<u32, Vec<(u32, ReleaseNearby)>>,
    /// Use of scarce blocks. `None` if there are enough.
    scarce: Option<ScarceBlocks<'a>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum StepEvent {
    Ends,
    /// The released block docks at the face of the step.
    Docks(u32),
    /// The face opens and waits for one of the scarce blocks.
    Opens,
}

/// A scheduled event. Times are stored as bits, which sort correctly because times are never
/// negative.
type Scheduled<T> = Reverse<(u64, u32, T)>;

fn time<T>(Reverse((bits, ..)): &Scheduled<T>) -> f64 {
    f64::from_bits(*bits)
}

/// State of a phase in one random sample.
struct PhaseDraw<'a, 'b> {
    phase: &'b TimedPhase<'a>,
    began: f64,
    /// For each step, the events that it still waits for.
    missing: Vec<Missing>,
    queue: BinaryHeap<Scheduled<StepEvent>>,
    few: Option<RemainingBlocks<'a, 'b>>,
    /// Run that continues. `None` for a new run.
    partial: Option<&'b PartialRun>,
    times: &'b mut DrawnTimes,
    rng: &'b mut ChaCha8Rng,
}

/// Number of events that a step still waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Missing {
    /// Predecessors that all must happen.
    all: u32,
    /// Events of the step's choice.
    chosen: u32,
}

impl Missing {
    fn new(step: &Step) -> Missing {
        Missing {
            all: step.before.len() as u32,
            chosen: step.choice.as_ref().map_or(0, |choice| choice.needed),
        }
    }

    fn is_none(self) -> bool {
        self.all == 0 && self.chosen == 0
    }
}

/// State of scarce free blocks during a phase.
///
/// If few free blocks remain, the arrival rates of all faces decrease by the same factor. Waiting
/// times therefore use a separate clock, whose speed is this factor.
struct RemainingBlocks<'a, 'b> {
    blocks: &'b ScarceBlocks<'a>,
    /// Number of bound blocks.
    taken: f64,
    /// Speed of the separate clock.
    speed: f64,
    /// Current time \[ticks\].
    now: f64,
    /// Value of the separate clock at `now`.
    clock: f64,
    /// For each open face, the arrival time of the block that will dock, on the separate clock.
    arrivals: BinaryHeap<Scheduled<()>>,
    /// For each step, the cumulative hazard at its capture.
    hazards: Vec<f64>,
}

impl<'a> TimedPhase<'a> {
    /// Prepares a phase. Returns `None` if it does not need a simulation in the order of time.
    pub fn new(
        steps: &'a [Step],
        waits: &'a [Option<CaptureWait>],
        scarce: Option<ScarceBlocks<'a>>,
    ) -> Option<TimedPhase<'a>> {
        let head_starts = |step: &Step| match &waits[step.event as usize] {
            Some(wait) => wait.head_starts.as_slice(),
            None => &[],
        };
        let is_in_order = |step: &Step| head_starts(step).is_empty() && step.choice.is_none();
        if scarce.is_none() && steps.iter().all(is_in_order) {
            return None;
        }
        let indices: FxHashMap<u32, usize> =
            (0..).zip(steps).map(|(i, it)| (it.event, i)).collect();
        let mut followers = vec![SmallVec::new(); steps.len()];
        let mut near: FxHashMap<u32, Vec<_>> = FxHashMap::default();
        for (i, step) in (0..).zip(steps) {
            for before in &step.before {
                followers[indices[before]].push((i, false));
            }
            for event in step.choice.iter().flat_map(|choice| &choice.events) {
                followers[indices[event]].push((i, true));
            }
            for (release, nearby) in head_starts(step) {
                if indices.contains_key(&release.0) {
                    near.entry(release.0).or_default().push((i, *nearby));
                }
            }
        }
        Some(TimedPhase {
            steps,
            waits,
            followers,
            near,
            scarce,
        })
    }

    /// Draws the event times of the phase. It starts at `began`. If `partial` is given, its run
    /// continues.
    pub fn draw(
        &self,
        began: f64,
        times: &mut DrawnTimes,
        rng: &mut ChaCha8Rng,
        partial: Option<&PartialRun>,
    ) {
        let few = self.scarce.as_ref().map(|blocks| RemainingBlocks {
            blocks,
            taken: blocks.before,
            speed: blocks.speed(blocks.before),
            now: began,
            clock: 0.0,
            arrivals: BinaryHeap::new(),
            hazards: vec![0.0; self.steps.len()],
        });
        let draw = PhaseDraw {
            phase: self,
            began,
            missing: self.steps.iter().map(Missing::new).collect(),
            queue: BinaryHeap::new(),
            few,
            partial,
            times,
            rng,
        };
        draw.run();
    }
}

impl PhaseDraw<'_, '_> {
    fn run(mut self) {
        for i in 0..self.phase.steps.len() as u32 {
            if self.missing[i as usize].is_none() {
                self.begin(i);
            }
        }
        loop {
            let next = self.queue.peek().map(time);
            let arrival = self.few.as_mut().and_then(|few| few.arrival_before(next));
            if let Some((step, end)) = arrival {
                self.schedule(end, step, StepEvent::Ends);
            } else if let Some(Reverse((bits, step, event))) = self.queue.pop() {
                self.come_to(f64::from_bits(bits), step, event);
            } else {
                return;
            }
        }
    }

    fn come_to(&mut self, time: f64, step: u32, what: StepEvent) {
        if let Some(few) = &mut self.few {
            few.pass(time);
        }
        let event = self.phase.steps[step as usize].event;
        if self.times.has_happened(event) {
            return;
        }
        match what {
            StepEvent::Opens => {
                if let Some(few) = &mut self.few {
                    few.open(step);
                }
                return;
            }
            StepEvent::Docks(release) => {
                let is_taken = &mut self.times.is_taken[release as usize];
                if std::mem::replace(is_taken, true) {
                    return;
                }
            }
            StepEvent::Ends => {}
        }
        self.happen(step, event, time);
    }

    /// Starts a step after all its predecessors have happened.
    fn begin(&mut self, step: u32) {
        let of = &self.phase.steps[step as usize];
        if let Some(tick) = self.partial.and_then(|run| run.happened(of.event)) {
            return self.schedule(tick, step, StepEvent::Ends);
        }
        let opens = self.times.begin(of, self.began, self.partial, self.rng);
        let Some(wait) = &self.phase.waits[of.event as usize] else {
            return self.schedule(opens, step, StepEvent::Ends);
        };
        let survived = self
            .partial
            .map_or(0.0, |run| run.survived(wait.wait, opens));
        let hazard = survived + exponential(self.rng);
        match &mut self.few {
            None => {
                let end = opens + wait.wait.about_time_of(hazard);
                self.schedule(end, step, StepEvent::Ends);
            }
            Some(few) => {
                few.hazards[step as usize] = hazard;
                if opens <= few.now {
                    few.open(step)
                } else {
                    self.schedule(opens, step, StepEvent::Opens)
                }
            }
        }
        for (release, nearby) in &wait.head_starts {
            if self.times.has_happened(release.0) {
                self.head_start(step, release.0, nearby, opens);
            }
        }
    }

    /// Completes an event and starts the steps that waited only for it.
    fn happen(&mut self, step: u32, event: u32, time: f64) {
        self.times.ends[event as usize] = time;
        if let Some(few) = &mut self.few {
            few.take(step);
        }
        for (other, nearby) in self.phase.near.get(&event).into_iter().flatten() {
            let capture = self.phase.steps[*other as usize].event;
            if self.missing[*other as usize].is_none() && !self.times.has_happened(capture) {
                // The face may open only when the notification of the release arrives.
                let opens = self.times.starts[capture as usize];
                self.head_start(*other, event, nearby, time.max(opens));
            }
        }
        for &(follower, is_choice) in &self.phase.followers[step as usize] {
            let missing = &mut self.missing[follower as usize];
            // Enough events of the choice have happened, so the step has begun.
            if missing.is_none() {
                continue;
            }
            if is_choice {
                missing.chosen = missing.chosen.saturating_sub(1);
            } else {
                missing.all -= 1;
            }
            if missing.is_none() {
                self.begin(follower);
            }
        }
    }

    /// Decides by chance whether a released block docks at a face that is open at this time.
    fn head_start(&mut self, step: u32, release: u32, nearby: &ReleaseNearby, time: f64) {
        let since = time - self.times.ends[release as usize];
        let Some(start) = nearby.after(since) else {
            return;
        };
        let now = self.partial.map_or(0.0, |run| run.now);
        for _ in 0..MAX_DRAWS {
            if self.rng.random::<f64>() >= start.probability {
                return;
            }
            let end = time + start.time(exponential(self.rng));
            // The run in progress has no capture before `now`, so such a draw is rejected.
            if end >= now {
                return self.schedule(end, step, StepEvent::Docks(release));
            }
        }
    }

    fn schedule(&mut self, time: f64, step: u32, event: StepEvent) {
        self.queue.push(Reverse((time.to_bits(), step, event)));
    }
}

impl RemainingBlocks<'_, '_> {
    /// Returns the next step whose block arrives, with its capture time \[ticks\]. `next` is the
    /// time of the next other event. Returns `None` if that event comes first.
    fn arrival_before(&mut self, next: Option<f64>) -> Option<(u32, f64)> {
        let left = time(self.arrivals.peek()?) - self.clock;
        let arrival = self.now + (left / self.speed).max(0.0);
        if next.is_some_and(|next| next < arrival) {
            return None;
        }
        let Reverse((clock, step, ())) = self.arrivals.pop()?;
        (self.now, self.clock) = (arrival, f64::from_bits(clock));
        let full = self.blocks.waits[step as usize]?;
        let wait = Wait {
            rate: full.rate * self.speed,
            ..full
        };
        // After the arrival, only docking takes time. Docking does not depend on the number of free
        // blocks.
        let hazard = self.hazards[step as usize];
        let docking = wait.about_time_of(hazard) - hazard / wait.rate;
        Some((step, arrival + docking.max(0.0)))
    }

    /// Advances both clocks to this time.
    fn pass(&mut self, time: f64) {
        self.clock += (time - self.now).max(0.0) * self.speed;
        self.now = self.now.max(time);
    }

    /// Schedules the arrival of a block at the face of a step.
    fn open(&mut self, step: u32) {
        if let Some(full) = self.blocks.waits[step as usize] {
            let due = self.clock + self.hazards[step as usize] / full.rate;
            self.arrivals.push(Reverse((due.to_bits(), step, ())));
        }
    }

    /// Updates the number of free blocks after a step.
    fn take(&mut self, step: u32) {
        let taken = self.blocks.taken[step as usize];
        if taken != 0.0 {
            self.taken += taken;
            self.speed = self.blocks.speed(self.taken);
        }
    }
}
