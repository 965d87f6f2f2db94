//! When a program is complete whose captures wait for each other: waits are drawn many times, and summed up along the graph.
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_ir::Cell;

use stochc_rates::{FORGOTTEN, Times};

use super::steps::Step;
use super::waits::{CaptureWait, within};
use crate::Program;

/// Waits that are drawn of a program, about.
const DRAWN: usize = 200_000;

/// Times that a program is gone through: more often if it is small.
const LEAST: usize = 20;
const MOST: usize = 4000;

/// The numbers are the same whenever a program is asked for.
const SEED: u64 = 0;

/// Nobody is before this event in its phase.
const NOBODY: u32 = u32::MAX;

/// One time that a program was gone through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// What it took \[tick\].
    pub ticks: f64,
    /// Whether all phases were complete before their timeouts.
    pub is_complete: bool,
}

/// What comes out.
pub struct Sampled {
    /// Of each phase; `None`: most draws did not come to its end.
    pub phases: Vec<Option<Times>>,
    /// Of the whole program.
    pub draws: Vec<Draw>,
    /// Whether two captures in cells beside each other wait at the same time, in one of the first [`LEAST`] draws.
    pub has_race: bool,
    /// For every event, the part of all time in which nothing else is waited for.
    pub shares: Vec<f64>,
}

/// Goes through the steps of a program many times.
pub fn sample(
    program: &Program,
    steps: &[Vec<Step>],
    timeouts: &[f64],
    waits: &[Option<CaptureWait>],
) -> Sampled {
    let count = waits.iter().flatten().count().max(1);
    let times = (DRAWN / count).clamp(LEAST, MOST);
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let neighbours = neighbours(program, waits);
    let mut starts = vec![0.0_f64; waits.len()];
    let mut ends = vec![0.0_f64; waits.len()];
    let mut last = vec![NOBODY; waits.len()];
    let mut durations = vec![Vec::with_capacity(times); program.plan.phases.len()];
    let mut draws = Vec::with_capacity(times);
    let mut decided = vec![0.0; waits.len()];
    let mut has_race = false;
    for number in 0..times {
        let mut total = 0.0;
        let mut is_complete = true;
        ends.fill(f64::INFINITY);
        for ((steps, durations), timeout) in steps.iter().zip(&mut durations).zip(timeouts) {
            let mut latest = (total, NOBODY);
            for Step { event, before } in steps {
                let mut start = (total, NOBODY);
                for &event in before {
                    if ends[event as usize] >= start.0 {
                        start = (ends[event as usize], event);
                    }
                }
                let wait = waits[*event as usize].as_ref();
                let end = wait.map_or(start.0, |wait| draw(wait, start.0, &ends, &mut rng));
                starts[*event as usize] = start.0;
                (ends[*event as usize], last[*event as usize]) = (end, start.1);
                if end >= latest.0 {
                    latest = (end, *event);
                }
            }
            if latest.0 - total > *timeout {
                total += timeout;
                is_complete = false;
                break;
            }
            let mut at = latest.1;
            while at != NOBODY {
                let before = last[at as usize];
                let since = if before == NOBODY {
                    total
                } else {
                    ends[before as usize]
                };
                decided[at as usize] += ends[at as usize] - since;
                at = before;
            }
            durations.push(latest.0 - total);
            total = latest.0;
        }
        has_race |= number < LEAST
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
    let all: f64 = draws.iter().map(|draw| draw.ticks).sum();
    decided
        .iter_mut()
        .for_each(|ticks| *ticks /= all.max(f64::MIN_POSITIVE));
    let phases = durations.into_iter();
    Sampled {
        phases: phases.map(|them| Times::of_most(them, times)).collect(),
        draws,
        has_race,
        shares: decided,
    }
}

/// Pairs of captures of one phase whose cells are beside each other, across edges and corners as well.
fn neighbours(program: &Program, waits: &[Option<CaptureWait>]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for phase in &program.plan.phases {
        let captures = phase.events.clone().map(|event| event as usize);
        let captures = captures.filter(|&event| waits[event].is_some());
        let mut before: FxHashMap<Cell, SmallVec<[usize; 1]>> = FxHashMap::default();
        for (event, cell) in captures.filter_map(|it| Some((it, program.layout.cells[it]?))) {
            let near = within(cell, 1).filter_map(|near| before.get(&near));
            pairs.extend(near.flatten().map(|&other| (other, event)));
            before.entry(cell).or_default().push(event);
        }
    }
    pairs
}

/// When a capture happens whose face opens at a time; `ends`: when other events happened, if they have \[tick\].
fn draw(of: &CaptureWait, opens: f64, ends: &[f64], rng: &mut ChaCha8Rng) -> f64 {
    let exponential = |rng: &mut ChaCha8Rng| -libm::log1p(-rng.random::<f64>());
    let mut end = opens + of.wait.time_of(exponential(rng));
    for &(release, start) in &of.head_starts {
        let released = ends[release.0 as usize];
        let left = 1.0 - (opens - released).max(0.0) / FORGOTTEN as f64;
        if released < end && rng.random::<f64>() < start.probability * left {
            end = end.min(opens.max(released) + start.ticks * exponential(rng));
        }
    }
    end
}
