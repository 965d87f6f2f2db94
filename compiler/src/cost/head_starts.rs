//! Phases in which blocks are released near open faces: gone through in the order of time, since the first of these faces that
//! takes a block has it, wherever the program says so.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use stochc_rates::ReleaseNearby;

use super::drawn_times::{DrawnTimes, exponential};
use super::steps::Step;
use super::waits::CaptureWait;

/// The steps of a phase, as they follow each other in time.
pub struct TimedPhase<'a> {
    steps: &'a [Step],
    waits: &'a [Option<CaptureWait>],
    /// Of each step those that wait for it.
    followers: Vec<Vec<u32>>,
    /// Of each release of the phase, the steps whose faces its block may dock on.
    near: FxHashMap<u32, Vec<(u32, ReleaseNearby)>>,
}

/// What may happen at a time, which is never negative, so that its bits are in its order; then the step, and the release whose block comes.
type Scheduled = Reverse<(u64, u32, Option<u32>)>;

/// A phase in one drawing.
struct PhaseDraw<'a, 'b> {
    phase: &'b TimedPhase<'a>,
    began: f64,
    /// Of each step how many others it still waits for.
    missing: Vec<usize>,
    queue: BinaryHeap<Scheduled>,
    times: &'b mut DrawnTimes,
    rng: &'b mut ChaCha8Rng,
}

impl<'a> TimedPhase<'a> {
    /// `None`: no released block has a head start in it.
    pub fn of(steps: &'a [Step], waits: &'a [Option<CaptureWait>]) -> Option<TimedPhase<'a>> {
        let head_starts = |step: &Step| match &waits[step.event as usize] {
            Some(wait) => wait.head_starts.as_slice(),
            None => &[],
        };
        if steps.iter().all(|step| head_starts(step).is_empty()) {
            return None;
        }
        let places: FxHashMap<u32, usize> = (0..).zip(steps).map(|(i, it)| (it.event, i)).collect();
        let mut followers = vec![Vec::new(); steps.len()];
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
        })
    }

    /// Draws when its events happen, once it has begun.
    pub fn draw(&self, began: f64, times: &mut DrawnTimes, rng: &mut ChaCha8Rng) {
        let draw = PhaseDraw {
            phase: self,
            began,
            missing: self.steps.iter().map(|step| step.before.len()).collect(),
            queue: BinaryHeap::new(),
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
        while let Some(Reverse((time, step, released))) = self.queue.pop() {
            let event = self.phase.steps[step as usize].event;
            let is_gone = |release: u32| self.times.is_taken[release as usize];
            if self.times.has_happened(event) || released.is_some_and(is_gone) {
                continue;
            }
            if let Some(release) = released {
                self.times.is_taken[release as usize] = true;
            }
            self.happen(step, event, f64::from_bits(time));
        }
    }

    /// A step has all that it waits for.
    fn begin(&mut self, step: u32) {
        let of = &self.phase.steps[step as usize];
        let opens = self.times.begin(of, self.began);
        let Some(wait) = &self.phase.waits[of.event as usize] else {
            return self.schedule(opens, step, None);
        };
        let end = opens + wait.wait.about_time_of(exponential(self.rng));
        self.schedule(end, step, None);
        for (release, nearby) in &wait.head_starts {
            if self.times.has_happened(release.0) {
                self.head_start(step, release.0, nearby, opens);
            }
        }
    }

    /// An event happens, and what it is waited for by may begin.
    fn happen(&mut self, step: u32, event: u32, time: f64) {
        self.times.ends[event as usize] = time;
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
            self.schedule(end, step, Some(release));
        }
    }

    fn schedule(&mut self, time: f64, step: u32, released: Option<u32>) {
        self.queue.push(Reverse((time.to_bits(), step, released)));
    }
}
