//! Samples completion times: draws waiting times repeatedly and sums them along the graph.
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_ir::{Cell, Draw};

use super::drawn_times::{DrawnTimes, NO_BLOCK};
use super::events::{Events, PhaseLimit};
use super::exponential::exponential;
use super::partial_run::PartialRun;
use super::scarcity::ScarceBlocks;
use super::steps::Step;
use super::timed_phase::TimedPhase;
use super::waits::{CaptureWait, within};
use crate::Times;

/// Approximate number of waiting times to draw for a program.
const DRAWN: usize = 200_000;

/// Smallest number of samples. Small programs get more.
const MIN: usize = 20;

/// Largest number of samples.
pub const MAX: usize = 4000;

/// Largest mean number of repetitions of phases per sample. Beyond it, fewer samples are drawn.
const MAX_RETRIED: usize = 16;

/// Seed. It is constant, so that estimates are reproducible.
const SEED: u64 = 0;

pub struct SampledPhase {
    /// Duration. `None` if at least nine tenths of the samples that reach the phase have a timeout
    /// in it.
    pub times: Option<Times>,
    /// Number of samples that reach the phase.
    pub reached: usize,
    /// Share of the phase's samples that end at its timeout.
    pub timed_out: f64,
    /// Share of the total time that the `wait` of the phase takes on critical paths.
    pub wait: f64,
}

impl SampledPhase {
    fn new(durations: Vec<f64>, timed_out: usize, wait: f64) -> SampledPhase {
        let reached = durations.len() + timed_out;
        SampledPhase {
            reached,
            timed_out: timed_out as f64 / reached.max(1) as f64,
            times: Times::new(durations, timed_out),
            wait,
        }
    }
}

pub struct Sampled {
    pub phases: Vec<SampledPhase>,
    /// Completion times of the whole program.
    pub draws: Vec<Draw>,
    /// Whether two captures in adjacent cells wait at the same time. Considers only the first
    /// [`MIN`] samples.
    pub has_race: bool,
    /// For each event, the share of the total time during which the critical path waits for it.
    pub shares: Vec<f64>,
    /// For each event, the mean time from its start to its end \[ticks\]. `None` if it never
    /// happened.
    pub waits: Vec<Option<f64>>,
}

/// Samples the event times of a program, at most `most` times. If `partial` is given, its run
/// continues.
pub fn sample(
    events: &Events<'_>,
    steps: &[Vec<Step>],
    limits: &[PhaseLimit],
    waits: &[Option<CaptureWait>],
    scarce: Option<Vec<ScarceBlocks<'_>>>,
    partial: Option<&PartialRun>,
    most: usize,
) -> Sampled {
    let count = waits.iter().flatten().count().max(1);
    let times = (DRAWN / count).clamp(MIN, MAX).min(most);
    let neighbours = neighbours(events, waits);
    let mut scarce = scarce.map(Vec::into_iter);
    let timed = steps.iter().map(|steps| {
        let scarce = scarce.as_mut().and_then(Iterator::next);
        TimedPhase::new(steps, waits, scarce)
    });
    let timed: Vec<Option<TimedPhase<'_>>> = timed.collect();
    let mut sampler = Sampler {
        waits,
        drawn: DrawnTimes::new(waits.len()),
        rng: ChaCha8Rng::seed_from_u64(SEED),
        decided: vec![0.0; waits.len()],
        waited: vec![(0.0, 0_u32); waits.len()],
        waiting: 0.0,
        retried: 0,
    };
    let mut durations = vec![Vec::with_capacity(times); steps.len()];
    let mut stopped = vec![0; steps.len()];
    let mut waiting = vec![0.0; steps.len()];
    let mut draws = Vec::with_capacity(times);
    let mut has_race = false;
    let first = partial.map_or(0, |run| run.phase.0 as usize);
    let earlier = steps.iter().take(first).flatten();
    let earlier: Vec<(u32, f64)> = earlier
        .filter_map(|step| Some((step.event, partial?.happened(step.event)?)))
        .collect();
    for number in 0..times {
        if number >= MIN && sampler.retried > MAX_RETRIED * times {
            break;
        }
        let mut total = 0.0;
        let mut is_complete = true;
        sampler.drawn.clear();
        for &(event, tick) in &earlier {
            sampler.drawn.set(event, tick);
        }
        let phases = steps.iter().zip(&timed).zip(&mut durations).zip(limits);
        for (phase, (((steps, timed), durations), limit)) in phases.enumerate().skip(first) {
            let partial = partial.filter(|_| phase == first);
            total = partial.map_or(total, |run| run.began);
            let (ended, is_timed_out) =
                sampler.phase(steps, timed.as_ref(), total, *limit, partial);
            waiting[phase] += std::mem::take(&mut sampler.waiting);
            if is_timed_out {
                total = ended;
                stopped[phase] += 1;
                is_complete = false;
                break;
            }
            durations.push(ended - total);
            total = ended;
        }
        let DrawnTimes { starts, ends, .. } = &sampler.drawn;
        has_race |= number < MIN
            && neighbours.iter().any(|&(one, other)| {
                starts[one] < ends[other]
                    && starts[other] < ends[one]
                    && ends[one].max(ends[other]).is_finite()
            });
        draws.push(Draw {
            ticks: total,
            is_complete,
        });
    }
    let Sampler {
        mut decided,
        waited,
        ..
    } = sampler;
    let all: f64 = draws.iter().map(|draw| draw.ticks).sum();
    let ticks = decided.iter_mut().chain(&mut waiting);
    ticks.for_each(|ticks| *ticks /= all.max(f64::MIN_POSITIVE));
    let phases = durations.into_iter().zip(stopped).zip(waiting);
    let waited = waited.into_iter();
    Sampled {
        phases: phases
            .map(|((them, never), wait)| SampledPhase::new(them, never, wait))
            .collect(),
        draws,
        has_race,
        shares: decided,
        waits: waited
            .map(|(sum, count)| (count > 0).then(|| sum / f64::from(count)))
            .collect(),
    }
}

/// State of the sampling.
struct Sampler<'a> {
    waits: &'a [Option<CaptureWait>],
    drawn: DrawnTimes,
    rng: ChaCha8Rng,
    /// For each event, the time during which the critical path waited for it \[ticks\].
    decided: Vec<f64>,
    /// For each event, the sum of its times from start to end \[ticks\], and their number.
    waited: Vec<(f64, u32)>,
    /// Time of the running phase during which its `wait` is on the critical path \[ticks\].
    waiting: f64,
    /// Number of repetitions of phases.
    retried: usize,
}

impl Sampler<'_> {
    /// Samples a phase that begins at `began`, with its retries. If `partial` is given, the first
    /// attempt continues its run. Returns the end, and whether the last attempt has timed out.
    fn phase(
        &mut self,
        steps: &[Step],
        timed: Option<&TimedPhase<'_>>,
        mut began: f64,
        limit: PhaseLimit,
        mut partial: Option<&PartialRun>,
    ) -> (f64, bool) {
        for _ in 0..partial.map_or(limit.retries, |run| run.retries) {
            let stop = began + limit.timeout;
            let ended = self.attempt(steps, timed, began, limit, partial.take());
            if ended <= stop {
                return (ended, false);
            }
            began = stop + limit.pause;
            self.retried += 1;
            self.drawn.begin_again(steps);
        }
        let stop = began + limit.timeout;
        let ended = self.attempt(steps, timed, began, limit, partial);
        (ended.min(stop), ended > stop)
    }

    /// Samples an attempt at a phase that begins at `total`, up to its timeout. Returns the tick when
    /// all reports have arrived and the `wait` of the phase is over, without a timeout.
    fn attempt(
        &mut self,
        steps: &[Step],
        timed: Option<&TimedPhase<'_>>,
        total: f64,
        limit: PhaseLimit,
        partial: Option<&PartialRun>,
    ) -> f64 {
        let Sampler {
            waits, drawn, rng, ..
        } = self;
        match timed {
            Some(timed) => timed.draw(total, drawn, rng, partial),
            None => draw_in_order(steps, waits, total, drawn, rng, partial),
        }
        let mut latest = (total, NO_BLOCK);
        for step in steps {
            let event = step.event;
            let (start, end) = (drawn.starts[event as usize], drawn.ends[event as usize]);
            let (sum, count) = &mut self.waited[event as usize];
            (*sum, *count) = (*sum + (end - start), *count + 1);
            let arrival = end + step.report(rng);
            if arrival >= latest.0 {
                latest = (arrival, event);
            }
        }
        let (earliest, stop) = (total + limit.wait, total + limit.timeout);
        if latest.0 < earliest {
            self.waiting += earliest.min(stop) - total;
            return earliest;
        }
        // After a timeout, the event on the critical path counts until the timeout.
        let mut at = latest.1;
        while at != NO_BLOCK {
            let before = drawn.last[at as usize];
            let since = if before == NO_BLOCK {
                total
            } else {
                drawn.ends[before as usize]
            };
            self.decided[at as usize] += drawn.ends[at as usize].min(stop) - since.min(stop);
            at = before;
        }
        latest.0
    }
}

/// Draws the event times of a phase in topological order. This requires that blocks are not scarce,
/// and that no block is released near an open face.
fn draw_in_order(
    steps: &[Step],
    waits: &[Option<CaptureWait>],
    began: f64,
    times: &mut DrawnTimes,
    rng: &mut ChaCha8Rng,
    partial: Option<&PartialRun>,
) {
    for step in steps {
        if let Some(tick) = partial.and_then(|run| run.happened(step.event)) {
            times.set(step.event, tick);
            continue;
        }
        let start = times.begin(step, began, partial, rng);
        let wait = waits[step.event as usize].as_ref();
        let end = wait.map_or(start, |wait| {
            let survived = partial.map_or(0.0, |run| run.survived(wait.wait, start));
            start + wait.wait.about_time_of(survived + exponential(rng))
        });
        times.ends[step.event as usize] = end;
    }
}

/// Returns pairs of captures of one phase with touching cells, across edges and corners too.
fn neighbours(events: &Events<'_>, waits: &[Option<CaptureWait>]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    let graph = events.parts.graph;
    for phase in events.phases() {
        let captures = graph.events_of(phase).map(|event| event.0 as usize);
        let captures = captures.filter(|&event| waits[event].is_some());
        let mut before: FxHashMap<Cell, SmallVec<[usize; 1]>> = FxHashMap::default();
        for (event, cell) in captures.filter_map(|it| Some((it, graph.events[it].cell?))) {
            let near = within(cell, 1).filter_map(|near| before.get(&near));
            pairs.extend(near.flatten().map(|&other| (other, event)));
            before.entry(cell).or_default().push(event);
        }
    }
    pairs
}
