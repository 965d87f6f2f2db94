//! When a program is complete whose captures wait for each other: waits are drawn many times, and summed up along the graph.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use stochc_rates::FORGOTTEN;

use super::waits::CaptureWait;
use crate::Program;
use crate::order::{Order, needed};

/// Waits that are drawn of a program, about.
const DRAWN: usize = 200_000;

/// Times that a program is gone through: more often if it is small.
const LEAST: usize = 10;
const MOST: usize = 4000;

/// The numbers are the same whenever a program is asked for.
const SEED: u64 = 0;

/// Nobody is before this event in its phase.
const NOBODY: u32 = u32::MAX;

/// Mean and quantiles of a time \[tick\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// Its mean.
    pub mean: f64,
    /// In a tenth of all cases it is less.
    pub p10: f64,
    /// In half of them.
    pub median: f64,
    /// In nine tenths.
    pub p90: f64,
}

/// What comes out.
pub struct Sampled {
    /// Of each phase.
    pub phases: Vec<Times>,
    /// Of all.
    pub total: Times,
    /// For every event, the part of all time in which nothing else is waited for.
    pub shares: Vec<f64>,
}

impl Times {
    /// `times` are some, in any order.
    fn of(mut times: Vec<f64>) -> Times {
        times.sort_unstable_by(f64::total_cmp);
        let at = |part: f64| times[(part * (times.len() - 1) as f64).round() as usize];
        Times {
            mean: times.iter().sum::<f64>() / times.len() as f64,
            p10: at(0.1),
            median: at(0.5),
            p90: at(0.9),
        }
    }
}

/// Goes through a program many times.
pub fn sample(program: &Program, order: &Order, waits: &[Option<CaptureWait>]) -> Sampled {
    let steps = steps(program, order);
    let count = waits.iter().flatten().count().max(1);
    let times = (DRAWN / count).clamp(LEAST, MOST);
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut ends = vec![0.0_f64; waits.len()];
    let mut last = vec![NOBODY; waits.len()];
    let mut durations = vec![Vec::with_capacity(times); program.plan.phases.len()];
    let mut totals = Vec::with_capacity(times);
    let mut decided = vec![0.0; waits.len()];
    for _ in 0..times {
        let mut total = 0.0;
        ends.fill(f64::INFINITY);
        for (steps, durations) in steps.iter().zip(&mut durations) {
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
                (ends[*event as usize], last[*event as usize]) = (end, start.1);
                if end >= latest.0 {
                    latest = (end, *event);
                }
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
        totals.push(total);
    }
    let all: f64 = totals.iter().sum();
    decided
        .iter_mut()
        .for_each(|ticks| *ticks /= all.max(f64::MIN_POSITIVE));
    Sampled {
        phases: durations.into_iter().map(Times::of).collect(),
        total: Times::of(totals),
        shares: decided,
    }
}

/// An event, and what it waits for.
struct Step {
    event: u32,
    before: Vec<u32>,
}

/// The events of each phase, each behind what it waits for.
fn steps(program: &Program, order: &Order) -> Vec<Vec<Step>> {
    let phases = &program.plan.phases;
    let mut steps: Vec<Vec<Step>> = phases.iter().map(|_| Vec::new()).collect();
    for &id in &order.events {
        let Some(phase) = program.plan.phase_of(id) else {
            continue;
        };
        let node = NodeIndex::new(id.0 as usize);
        let before = needed(&program.graph, &order.unneeded, node, Incoming)
            .map(|edge| edge.source().index() as u32)
            .filter(|event| phases[phase].events.contains(event));
        steps[phase].push(Step {
            event: id.0,
            before: before.collect(),
        });
    }
    steps
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
