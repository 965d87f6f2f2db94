//! Counts by place, summed over runs.
use std::collections::BTreeMap;

use stochc_experiments::resampling::{Ratio, Replicates};

/// Counts of one run by place, with their common denominator.
#[derive(Clone, Debug, Default)]
pub(super) struct Counts<K> {
    by: BTreeMap<K, f64>,
    /// Common denominator of all counts, such as a number of ticks.
    pub of: f64,
}

impl<K: Ord> Counts<K> {
    pub fn add(&mut self, place: K, much: f64) {
        *self.by.entry(place).or_default() += much;
    }
}

/// Counts summed over runs, with bootstrap samples.
pub(super) struct Tally<K> {
    by: BTreeMap<K, Replicates>,
    of: Replicates,
}

impl<K: Ord + Copy> Tally<K> {
    pub fn new() -> Tally<K> {
        Tally {
            by: BTreeMap::new(),
            of: Replicates::default(),
        }
    }

    pub fn add(&mut self, counts: Counts<K>, weights: &[u8]) {
        for (place, much) in counts.by {
            self.by.entry(place).or_default().add(much, weights);
        }
        self.of.add(counts.of, weights);
    }

    /// Returns the counts of a place divided by `volume` and by the denominator. Returns `None` if
    /// the denominator is 0.
    pub fn ratio(&self, place: K, volume: f64) -> Option<Ratio> {
        match self.by.get(&place) {
            Some(counts) => counts.over(&self.of, volume),
            // A place without counts is 0 in each bootstrap sample.
            None => Replicates::default().over(&self.of, volume),
        }
    }
}
