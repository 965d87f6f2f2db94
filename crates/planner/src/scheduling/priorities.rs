//! What a schedule is made by: which site is more urgent, by which way its block comes, and how sites are placed.
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::search::SMALL;

/// Of all sites of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Priorities {
    /// Of each site, how urgent it is beside what its tail says: mostly 0 to 1 (J. C. Bean, *Genetic algorithms and random keys for sequencing and
    /// optimization*, ORSA Journal on Computing 6, 1994), and above -0.5.
    keys: Vec<f32>,
    /// Of each site, how many better ways into it are left out.
    skipped: Vec<u8>,
    /// Whether sites are placed one after the other, or opened as soon as they may.
    pub is_serial: bool,
    /// Whether it is by the means of the program that it is seen which of several faces near one closes last, for which that one need not wait.
    pub is_settled: bool,
}

impl Priorities {
    /// All alike, each by its best way.
    pub fn even(sites: usize) -> Priorities {
        Priorities {
            keys: vec![0.5; sites],
            skipped: vec![0; sites],
            is_serial: false,
            is_settled: false,
        }
    }

    /// Any.
    pub fn random(sites: usize, rng: &mut ChaCha8Rng) -> Priorities {
        let critical = vec![1.0; sites];
        let even = Priorities::even(sites);
        (0..sites).fold(even, |other, _| other.changed(&critical, true, rng))
    }

    /// How urgent a site is with such a tail \[ticks\].
    pub fn urgency(&self, site: u32, tail: f32) -> f32 {
        tail * (0.5 + self.keys[site as usize])
    }

    /// One of the ways into a site, each with its price.
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

    /// Others of which a few are different: mostly of sites that decide when a run ends. `may_be_serial`: whether there are serial schedules.
    pub fn changed(
        &self,
        critical: &[f32],
        may_be_serial: bool,
        rng: &mut ChaCha8Rng,
    ) -> Priorities {
        const MAX: usize = 4;
        /// One change in so many is of a way, and one in so many of how sites are placed, or of whose means count.
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

/// How urgent one of so many sites is beside what its tail says. Of a small target, one change in as many makes it far more or far less urgent
/// than tails ever do, so that what comes last by them may come first.
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

/// Of three sites at random, the one that decides most often when a run ends.
fn critical_site(critical: &[f32], rng: &mut ChaCha8Rng) -> u32 {
    let mut three = (0..3).map(|_| rng.random_range(0..critical.len()));
    let first = three.next().expect("three are drawn");
    three.fold(first, |a, b| if critical[b] > critical[a] { b } else { a }) as u32
}
