//! Which waits add up.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use crate::Program;
use crate::order::Order;
use crate::plan::Deed;
use crate::turns::{Earliest, earliest};

/// Exposures below this are taken for it: the wait stays finite.
const LEAST_EXPOSURE: f64 = 0.01;

/// Sets of waits that the shares are averaged over, for small programs and for all.
const MOST_SAMPLES: usize = 512;
const LEAST_SAMPLES: usize = 16;
const SAMPLED_EVENTS: usize = 4_000_000;

/// The mean wait for a cell, in waits of a cell that is open to all sides.
pub fn wait(exposure: f64) -> f64 {
    1.0 / exposure.max(LEAST_EXPOSURE)
}

/// For every event, the captures of the longest chain of its phase that ends in it.
pub fn levels(program: &Program, order: &Order) -> Vec<u32> {
    let mut levels = vec![0; program.plan.events.len()];
    for &id in &order.events {
        let node = NodeIndex::new(id.0 as usize);
        let before = (program.graph.edges_directed(node, Incoming))
            .filter(|edge| !order.unneeded.contains(&edge.id()))
            .map(|edge| levels[edge.source().index()])
            .max();
        let is_capture = program.plan.event(id).deed != Deed::Release;
        levels[id.0 as usize] = before.unwrap_or(0) + u32::from(is_capture);
    }
    levels
}

/// How the time to completion is made up.
pub struct Shares {
    /// Mean time to completion.
    pub time: f64,
    /// Mean time of each phase.
    pub phases: Vec<f64>,
    /// For every event, the mean of its wait where it is on the chain that decides.
    pub captures: Vec<f64>,
}

/// Averages over sets of exponential waits. The sets are a fixed rule of integration, the same
/// for every call: nothing here is left to chance.
pub fn shares(program: &Program, order: &Order, exposures: &[Option<f64>]) -> Shares {
    let plan = &program.plan;
    let count = plan.events.len();
    let samples = (SAMPLED_EVENTS / count.max(1)).clamp(LEAST_SAMPLES, MOST_SAMPLES);
    let samples = 1usize << samples.ilog2();
    let mut shares = Shares {
        time: 0.0,
        phases: vec![0.0; plan.phases.len()],
        captures: vec![0.0; count],
    };
    let weight = 1.0 / samples as f64;
    let has_choice = !order.unneeded.is_empty();
    let mut times = Earliest {
        over: vec![0.0; count],
        last: vec![u32::MAX; count],
        events: Vec::new(),
    };
    for sample in 0..samples as u64 {
        let length = |i: usize| match exposures[i] {
            Some(exposure) => wait(exposure) * exponential(sample, samples as u64, i as u64),
            None => 0.0,
        };
        if has_choice {
            times = earliest(&program.graph, length);
        } else {
            in_order(program, order, length, &mut times);
        }
        let Earliest { over, last, .. } = &times;
        for (phase, spent) in plan.phases.iter().zip(&mut shares.phases) {
            let end = phase
                .events
                .clone()
                .max_by(|&a, &b| over[a as usize].total_cmp(&over[b as usize]));
            let Some(end) = end else { continue };
            *spent += over[end as usize] * weight;
            shares.time += over[end as usize] * weight;
            let mut at = end;
            while at != u32::MAX {
                shares.captures[at as usize] += length(at as usize) * weight;
                at = last[at as usize];
            }
        }
    }
    shares
}

/// The same as [`earliest`] for a graph without choices, quicker.
fn in_order(program: &Program, order: &Order, length: impl Fn(usize) -> f64, times: &mut Earliest) {
    let Earliest { over, last, .. } = times;
    for &id in &order.events {
        let i = id.0 as usize;
        let (mut start, mut before) = (0.0, u32::MAX);
        for edge in program.graph.edges_directed(NodeIndex::new(i), Incoming) {
            let first = edge.source().index();
            if before == u32::MAX || over[first] > start {
                (start, before) = (over[first], first as u32);
            }
        }
        over[i] = start + length(i);
        last[i] = before;
    }
}

/// Of `samples` numbers with the exponential distribution, one from each of as many equal parts of it,
/// the one in place `sample`; every event has the same numbers in another order.
fn exponential(sample: u64, samples: u64, event: u64) -> f64 {
    let part = shuffled(sample, samples - 1, mixed(event));
    -((part as f64 + 0.5) / samples as f64).ln()
}

/// A permutation of the numbers from 0 to `mask`, which is one less than a power of two.
fn shuffled(number: u64, mask: u64, key: u64) -> u64 {
    let half = mask.count_ones().div_ceil(2);
    // Each step can be undone, so no number comes twice.
    let mut number = (number ^ key) & mask;
    for round in 1..=3 {
        number = number.wrapping_mul(key >> (8 * round) | 1) & mask;
        number ^= number >> half;
        number = number.wrapping_add(key >> (16 * round)) & mask;
    }
    number
}

/// The finalizer of SplitMix64.
fn mixed(number: u64) -> u64 {
    let mut bits = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_event_has_every_part_once() {
        for event in 0..200 {
            let mut parts: Vec<u64> = (0..512).map(|i| shuffled(i, 511, mixed(event))).collect();
            parts.sort_unstable();
            assert!(parts.into_iter().eq(0..512), "{event}");
        }
    }

    #[test]
    fn the_numbers_have_mean_one_and_different_events_are_hardly_correlated() {
        let numbers = |event| (0..512u64).map(move |i| exponential(i, 512, event));
        let mean: f64 = numbers(7).sum::<f64>() / 512.0;
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
        let mut worst: f64 = 0.0;
        let mut squares = 0.0;
        for event in 0..400 {
            let product = |(a, b): (f64, f64)| (a - mean) * (b - mean);
            let sum: f64 = numbers(event).zip(numbers(event + 1)).map(product).sum();
            let correlation = sum / 512.0;
            worst = worst.max(correlation.abs());
            squares += correlation * correlation;
        }
        // Independent ones would have 1 / sqrt(512) = 0.044.
        assert!((squares / 400.0f64).sqrt() < 0.06, "{squares}");
        assert!(worst < 0.3, "{worst}");
    }
}
