//! Counts by place, and their sums over runs.
use std::collections::BTreeMap;

use stochc_experiments::resampling::{Ratio, Replicates};

/// Counts of a run for the sums over runs.
#[derive(Clone, Debug, Default)]
pub(super) struct Counts<K> {
    by: BTreeMap<K, f64>,
    /// Denominator of the counts.
    pub of: f64,
}

impl<K: Ord> Counts<K> {
    pub fn add(&mut self, place: K, much: f64) {
        *self.by.entry(place).or_default() += much;
    }
}

/// Sums over runs, for each bootstrap sample.
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

    /// Returns the counts of a cell divided by `volume` times the denominator.
    pub fn ratio(&self, place: K, volume: f64) -> Option<Ratio> {
        match self.by.get(&place) {
            Some(counts) => counts.over(&self.of, volume),
            // A place without counts has 0 in each sample.
            None => Replicates::default().over(&self.of, volume),
        }
    }
}
