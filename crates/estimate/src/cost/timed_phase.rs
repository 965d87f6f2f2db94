//! Phases that are gone through in the order of time: where blocks are released near open faces, since the first of these that
//! takes a block has it, wherever the program says so; and where free blocks are scarce, which all chains take from each other.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::drawn_times::{DrawnTimes, exponential};
use super::events::Step;
use super::scarcity::ScarceBlocks;
use super::waits::CaptureWait;
use crate::{ReleaseNearby, Wait};

/// The steps of a phase, as they follow each other in time.
pub struct TimedPhase<'a> {
    steps: &'a [Step],
    waits: &'a [Option<CaptureWait>],
    /// Of each step those that wait for it.
    followers: Vec<SmallVec<[u32; 2]>>,
    /// Of each release of the phase, the steps whose faces its block may dock on.
    near: FxHashMap<u32, Vec<(u32, ReleaseNearby)>>,
    /// `None`: there are enough free blocks.
    scarce: Option<ScarceBlocks<'a>>,
}

/// What may happen to a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum StepEvent {
    /// It is over.
    Ends,
    /// The block of a release docks.
    Docks(u32),
    /// Its face opens, and waits for one of few blocks.
    Opens,
}

/// Something at a time that is never negative, so that its bits are in its order.
type Scheduled<T> = Reverse<(u64, u32, T)>;

fn time<T>(Reverse((bits, ..)): &Scheduled<T>) -> f64 {
    f64::from_bits(*bits)
}

/// A phase in one drawing.
struct PhaseDraw<'a, 'b> {
    phase: &'b TimedPhase<'a>,
    began: f64,
    /// Of each step how many others it still waits for.
    missing: Vec<u32>,
    queue: BinaryHeap<Scheduled<StepEvent>>,
    few: Option<RemainingBlocks<'a, 'b>>,
    times: &'b mut DrawnTimes,
    rng: &'b mut ChaCha8Rng,
}

/// The free blocks while a phase goes on that are scarce in it.
///
/// With few blocks left all faces wait longer by the same factor. So their waits pass by a clock of their own: it runs as fast as rates are over those
/// of the full gas.
struct RemainingBlocks<'a, 'b> {
    blocks: &'b ScarceBlocks<'a>,
    /// How many are taken, and how fast the clock runs for that.
    taken: f64,
    speed: f64,
    /// \[tick\]
    now: f64,
    /// What the clock says then.
    clock: f64,
    /// By the clock, when the block that will dock comes into reach of each open face.
    arrivals: BinaryHeap<Scheduled<()>>,
    /// Of each step, the hazard that it has to go through.
    hazards: Vec<f64>,
}

impl<'a> TimedPhase<'a> {
    /// `None`: no released block has a head start in it, and there are enough free blocks.
    pub fn new(
        steps: &'a [Step],
        waits: &'a [Option<CaptureWait>],
        scarce: Option<ScarceBlocks<'a>>,
    ) -> Option<TimedPhase<'a>> {
        let head_starts = |step: &Step| match &waits[step.event as usize] {
            Some(wait) => wait.head_starts.as_slice(),
            None => &[],
        };
        if scarce.is_none() && steps.iter().all(|step| head_starts(step).is_empty()) {
            return None;
        }
        let places: FxHashMap<u32, usize> = (0..).zip(steps).map(|(i, it)| (it.event, i)).collect();
        let mut followers = vec![SmallVec::new(); steps.len()];
        let mut near: FxHashMap<u32, Vec<_>> = FxHashMap::default();
        for (i, step) in (0..).zip(steps) {
            for before in &step.before {
                followers[places[before]].push(i);
            }
            for (release, nearby) in head_starts(step) {
                if places.contains_key(&release.0) {
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

    /// Draws when its events happen, once it has begun.
    pub fn draw(&self, began: f64, times: &mut DrawnTimes, rng: &mut ChaCha8Rng) {
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
            missing: self
                .steps
                .iter()
                .map(|step| step.before.len() as u32)
                .collect(),
            queue: BinaryHeap::new(),
            few,
            times,
            rng,
        };
        draw.run();
    }
}

impl PhaseDraw<'_, '_> {
    fn run(mut self) {
        for (i, step) in (0..).zip(self.phase.steps) {
            if step.before.is_empty() {
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

    /// A step has all that it waits for.
    fn begin(&mut self, step: u32) {
        let of = &self.phase.steps[step as usize];
        let opens = self.times.begin(of, self.began, self.rng);
        let Some(wait) = &self.phase.waits[of.event as usize] else {
            return self.schedule(opens, step, StepEvent::Ends);
        };
        let hazard = exponential(self.rng);
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

    /// An event happens, and what it is waited for by may begin.
    fn happen(&mut self, step: u32, event: u32, time: f64) {
        self.times.ends[event as usize] = time;
        if let Some(few) = &mut self.few {
            few.take(step);
        }
        for (other, nearby) in self.phase.near.get(&event).into_iter().flatten() {
            let capture = self.phase.steps[*other as usize].event;
            if self.missing[*other as usize] == 0 && !self.times.has_happened(capture) {
                // Its face may have to hear of this first.
                let opens = self.times.starts[capture as usize];
                self.head_start(*other, event, nearby, time.max(opens));
            }
        }
        for &follower in &self.phase.followers[step as usize] {
            self.missing[follower as usize] -= 1;
            if self.missing[follower as usize] == 0 {
                self.begin(follower);
            }
        }
    }

    /// By chance, the block of a release docks on a face that is open at this time.
    fn head_start(&mut self, step: u32, release: u32, nearby: &ReleaseNearby, time: f64) {
        let since = time - self.times.ends[release as usize];
        let Some(start) = nearby.after(since) else {
            return;
        };
        if self.rng.random::<f64>() < start.probability {
            let end = time + start.time(exponential(self.rng));
            self.schedule(end, step, StepEvent::Docks(release));
        }
    }

    fn schedule(&mut self, time: f64, step: u32, event: StepEvent) {
        self.queue.push(Reverse((time.to_bits(), step, event)));
    }
}

impl RemainingBlocks<'_, '_> {
    /// Returns the next block that comes into reach of a face, if that is before this time, which
    /// nothing else is: whose face, and when it is captured.
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
        // What of the wait is no waiting for it is docking, which takes as long in any gas.
        let hazard = self.hazards[step as usize];
        let docking = wait.about_time_of(hazard) - hazard / wait.rate;
        Some((step, arrival + docking.max(0.0)))
    }

    /// Time passes, until something happens.
    fn pass(&mut self, time: f64) {
        self.clock += (time - self.now).max(0.0) * self.speed;
        self.now = self.now.max(time);
    }

    /// Has a face wait for the block that will dock.
    fn open(&mut self, step: u32) {
        if let Some(full) = self.blocks.waits[step as usize] {
            let due = self.clock + self.hazards[step as usize] / full.rate;
            self.arrivals.push(Reverse((due.to_bits(), step, ())));
        }
    }

    /// A step is over, and leaves more or fewer free blocks.
    fn take(&mut self, step: u32) {
        let taken = self.blocks.taken[step as usize];
        if taken != 0.0 {
            self.taken += taken;
            self.speed = self.blocks.speed(self.taken);
        }
    }
}
