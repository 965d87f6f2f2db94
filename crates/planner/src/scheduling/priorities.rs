//! Priorities of a schedule: urgency and direction of each site, and the method of placing sites.
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::target::limits::SMALL;

/// Priorities of all sites of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Priorities {
    /// Urgency of each site relative to its tail: usually 0 to 1, above -0.5.
    ///
    /// # Source
    ///
    /// J. C. Bean, *Genetic algorithms and random keys for sequencing and optimization*, ORSA
    /// Journal on Computing 6 (1994).
    keys: Vec<f32>,
    /// Number of better directions skipped for each site.
    skipped: Vec<u8>,
    /// Whether sites are placed one by one, instead of opened as soon as possible.
    pub is_serial: bool,
    /// Whether the program's mean waiting times decide which of several nearby faces closes last
    /// and need not be waited for.
    pub is_settled: bool,
}

impl Priorities {
    /// Returns equal priorities with the best directions.
    pub fn even(sites: usize) -> Priorities {
        Priorities {
            keys: vec![0.5; sites],
            skipped: vec![0; sites],
            is_serial: false,
            is_settled: false,
        }
    }

    /// Returns random priorities.
    pub fn random(sites: usize, rng: &mut ChaCha8Rng) -> Priorities {
        let critical = vec![1.0; sites];
        let even = Priorities::even(sites);
        (0..sites).fold(even, |other, _| other.changed(&critical, true, rng))
    }

    /// Returns the urgency of a site with this tail \[ticks\].
    pub(crate) fn urgency(&self, site: u32, tail: f32) -> f32 {
        tail * (0.5 + self.keys[site as usize])
    }

    /// Returns the selected direction into a site, by price.
    pub fn chosen<T>(&self, site: u32, ways: impl Iterator<Item = (T, f32)>) -> Option<T> {
        let skipped = usize::from(self.skipped[site as usize]);
        if skipped == 0 {
            return ways.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(way, _)| way);
        }
        let mut ways: Vec<(T, f32)> = ways.collect();
        ways.sort_by(|a, b| a.1.total_cmp(&b.1));
        let last = ways.len().checked_sub(1)?;
        Some(ways.swap_remove(skipped.min(last)).0)
    }

    /// Returns changed priorities. Most changes are at critical sites. `may_be_serial` is whether
    /// serial schedules are allowed.
    pub fn changed(
        &self,
        critical: &[f32],
        may_be_serial: bool,
        rng: &mut ChaCha8Rng,
    ) -> Priorities {
        const MAX: usize = 4;
        /// One in this many changes selects another direction, and one in as many another method or
        /// source of means.
        const WAYS: u32 = 4;
        const PLACING: u32 = 8;
        let mut other = self.clone();
        other.is_serial ^= may_be_serial && rng.random_range(0..PLACING) == 0;
        other.is_settled ^= may_be_serial && rng.random_range(0..PLACING) == 0;
        for _ in 0..rng.random_range(1..=MAX) {
            let site = critical_site(critical, rng) as usize;
            if rng.random_range(0..WAYS) == 0 {
                let skipped = &mut other.skipped[site];
                *skipped = match *skipped {
                    0 => rng.random_range(1..=2),
                    _ => 0,
                };
            } else {
                other.keys[site] = key(critical.len(), rng);
            }
        }
        other
    }
}

/// Returns a random urgency relative to the tail. In small targets, some are extreme, so that the
/// last site by tails can come first.
fn key(sites: usize, rng: &mut ChaCha8Rng) -> f32 {
    const OFTENEST: u32 = 4;
    const MAX: f32 = 7.0;
    const MIN: f32 = -0.45;
    let is_far = sites <= SMALL && rng.random_ratio(1, OFTENEST.max(sites as u32));
    match is_far {
        false => rng.random(),
        true if rng.random() => 1.0 + MAX * rng.random::<f32>(),
        true => MIN * rng.random::<f32>(),
    }
}

/// Returns the most critical of three random sites.
fn critical_site(critical: &[f32], rng: &mut ChaCha8Rng) -> u32 {
    let mut three = (0..3).map(|_| rng.random_range(0..critical.len()));
    let first = three.next().expect("three are drawn");
    three.fold(first, |a, b| if critical[b] > critical[a] { b } else { a }) as u32
}
