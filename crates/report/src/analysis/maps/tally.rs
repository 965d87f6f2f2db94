//! Counts by place, and sums of them over runs.
use std::collections::BTreeMap;

use stochc_experiments::resampling::{Ratio, Replicates};

/// What a run adds to sums over runs.
#[derive(Clone, Debug, Default)]
pub(super) struct Counts<K> {
    by: BTreeMap<K, f64>,
    /// What they are held against.
    pub of: f64,
}

impl<K: Ord> Counts<K> {
    pub fn add(&mut self, place: K, much: f64) {
        *self.by.entry(place).or_default() += much;
    }
}

/// Sums over runs, in each of the bootstrap's samples.
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

    /// Counts over what they are held against and `volume`.
    pub fn ratio(&self, place: K, volume: f64) -> Option<Ratio> {
        match self.by.get(&place) {
            Some(counts) => counts.over(&self.of, volume),
            // Nowhere seen is 0 in each sample.
            None => Replicates::default().over(&self.of, volume),
        }
    }
}
