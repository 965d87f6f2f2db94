//! Numbers of docking blocks in the states of a Markov chain.
use std::collections::{BTreeMap, BTreeSet};

use stochc_runtime::rates::{CaptureState, OpenCapture};

/// Largest probabilities that an arriving block finds as many docking blocks as the chain counts.
/// Each has a limit on the number of states of the chain. The chain uses the first probability
/// whose limit suffices.
const LOST: [(f64, f64); 3] = [(1e-10, 1e5), (1e-8, 1e5), (1e-6, 2e6)];

/// A counter of docking blocks: the number of the group of faces, and the bits of the mean docking
/// time.
type Key = (usize, u64);

/// Counter of the docking blocks at the faces of a group, for one mean docking time.
///
/// Blocks arrive at the total rate of these faces, or at the largest total rate of all states. A
/// block that has docked belongs to a face with the probability that the rates give, and is
/// otherwise ignored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DockingCounter {
    /// Rate of arrivals \[1/tick\].
    pub arrivals: f64,
    /// Mean docking time \[ticks\].
    pub docking: f64,
    /// Largest number of docking blocks.
    pub most: usize,
}

/// Counters of all states. A counter exists while its docking time is the one of an open face, or
/// can still become so.
#[derive(Debug)]
pub struct DockingCounters {
    of_states: Vec<BTreeSet<Key>>,
    all: BTreeMap<Key, DockingCounter>,
    /// Probability that an arriving block is ignored because of `most`.
    pub lost: f64,
}

impl DockingCounter {
    fn new((_, docking): Key, arrivals: f64, lost: f64) -> DockingCounter {
        let docking = f64::from_bits(docking);
        DockingCounter {
            arrivals,
            docking,
            most: most_docking(arrivals * docking, lost),
        }
    }
}

fn key(open: &OpenCapture) -> Key {
    (open.group, open.wait.docking.to_bits())
}

/// Returns the total rates of the open faces of a state, by counter.
fn total_rates(state: &CaptureState) -> BTreeMap<Key, f64> {
    let mut totals = BTreeMap::new();
    for open in &state.open {
        *totals.entry(key(open)).or_default() += open.wait.rate;
    }
    totals
}

impl DockingCounters {
    /// Returns the counters of these states. Returns `None` if the chain has too many states.
    pub fn new(states: &[CaptureState]) -> Option<DockingCounters> {
        let mut of_states = vec![BTreeSet::new(); states.len()];
        let mut rates: BTreeMap<Key, f64> = BTreeMap::new();
        for (number, state) in states.iter().enumerate().rev() {
            let mut keys = BTreeSet::new();
            for (key, total) in total_rates(state) {
                keys.insert(key);
                let rate = rates.entry(key).or_default();
                *rate = rate.max(total);
            }
            let is_open = |(group, _): &&Key| state.open.iter().any(|open| open.group == *group);
            for open in &state.open {
                let later: &BTreeSet<Key> = &of_states[open.next];
                keys.extend(later.iter().filter(is_open));
            }
            of_states[number] = keys;
        }
        LOST.into_iter().find_map(|(lost, max)| {
            let counters = rates.iter();
            let counters =
                counters.map(|(&key, &rate)| (key, DockingCounter::new(key, rate, lost)));
            let all = counters.collect();
            (size(&of_states, &all) <= max).then(|| DockingCounters {
                of_states: of_states.clone(),
                all,
                lost,
            })
        })
    }

    /// Returns the counters of a state.
    pub fn of_state(&self, state: usize) -> impl Iterator<Item = DockingCounter> + '_ {
        self.of_states[state].iter().map(|of| self.all[of])
    }

    /// Returns the largest number of blocks of each counter, by index of the counter.
    pub fn most(&self) -> Vec<usize> {
        let mut most = Vec::new();
        for state in 0..self.of_states.len() {
            for (index, counter) in self.of_state(state).enumerate() {
                most.resize(most.len().max(index + 1), 0);
                most[index] = counter.most.max(most[index]);
            }
        }
        most
    }

    /// Returns the index of the counter of an open face in a state.
    pub fn index(&self, state: usize, open: &OpenCapture) -> usize {
        self.of_states[state].range(..key(open)).count()
    }

    /// Returns the indices of the counters of state `after` in state `before`. Returns `None` for
    /// counters that begin at 0.
    pub fn origins(&self, before: usize, after: usize) -> impl Iterator<Item = Option<usize>> + '_ {
        let before = &self.of_states[before];
        let origin = move |of: &Key| before.iter().position(|it| it == of);
        self.of_states[after].iter().map(origin)
    }
}

/// Returns the number of states of a chain.
fn size(of_states: &[BTreeSet<Key>], all: &BTreeMap<Key, DockingCounter>) -> f64 {
    let states = of_states.iter().map(|keys| {
        let most = keys.iter().map(|of| all[of].most as f64);
        most.map(|most| (most + 1.0) * (most + 2.0) / 2.0)
            .product::<f64>()
    });
    states.sum()
}

/// Returns the number of docking blocks that the chain counts. `mean` is the mean number of docking
/// blocks without captures. This number has a Poisson distribution.
fn most_docking(mean: f64, lost: f64) -> usize {
    let (mut count, mut term, mut below) = (0, (-mean).exp(), 0.0);
    while 1.0 - below > lost && count < 1000 {
        below += term;
        count += 1;
        term *= mean / count as f64;
    }
    count.max(1)
}

#[cfg(test)]
mod tests {
    use super::most_docking;

    #[test]
    fn enough_docking_blocks_are_counted() {
        // P(X >= 10) = 1.7e-10 and P(X >= 11) = 7.7e-12 for a Poisson variable with mean 0.5.
        assert_eq!(most_docking(0.5, 1e-10), 11);
        assert_eq!(most_docking(0.5, 1e-6), 8);
        assert_eq!(most_docking(0.0, 1e-10), 1);
    }
}
