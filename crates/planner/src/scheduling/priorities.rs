//! Priorities of a schedule: urgency and direction of each site.
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

/// Priorities of all sites of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Priorities {
    /// Urgency of each site relative to its tail, 0 to 1.
    ///
    /// # Source
    ///
    /// J. C. Bean, *Genetic algorithms and random keys for sequencing and optimization*, ORSA
    /// Journal on Computing 6 (1994).
    keys: Vec<f32>,
    /// For each site, the number of cheaper directions to skip when a direction is selected.
    skipped: Vec<u8>,
}

impl Priorities {
    /// Returns equal priorities with the best directions.
    pub fn even(sites: usize) -> Priorities {
        Priorities {
            keys: vec![0.5; sites],
            skipped: vec![0; sites],
        }
    }

    /// Returns the urgency of a site: its tail \[ticks\], multiplied by 0.5 to 1.5 depending on its
    /// key.
    pub(crate) fn urgency(&self, site: u32, tail: f32) -> f32 {
        tail * (0.5 + self.keys[site as usize])
    }

    /// Returns the direction into a site that the priorities select. `choices` contains pairs of
    /// direction and price. Returns `None` if `choices` is empty.
    pub fn chosen<T>(&self, site: u32, choices: impl Iterator<Item = (T, f32)>) -> Option<T> {
        let skipped = usize::from(self.skipped[site as usize]);
        if skipped == 0 {
            return choices
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(choice, _)| choice);
        }
        let mut choices: Vec<(T, f32)> = choices.collect();
        choices.sort_by(|a, b| a.1.total_cmp(&b.1));
        let last = choices.len().checked_sub(1)?;
        Some(choices.swap_remove(skipped.min(last)).0)
    }

    /// Returns changed priorities. Most changes are at critical sites.
    pub fn changed(&self, critical: &[f32], rng: &mut ChaCha8Rng) -> Priorities {
        const MAX: usize = 4;
        /// On average, one change in `ODDS` selects another direction.
        const ODDS: u32 = 4;
        let mut other = self.clone();
        for _ in 0..rng.random_range(1..=MAX) {
            let site = critical_site(critical, rng) as usize;
            if rng.random_range(0..ODDS) == 0 {
                let skipped = &mut other.skipped[site];
                *skipped = match *skipped {
                    0 => rng.random_range(1..=2),
                    _ => 0,
                };
            } else {
                other.keys[site] = rng.random();
            }
        }
        other
    }
}

/// Returns the most critical of three random sites.
fn critical_site(critical: &[f32], rng: &mut ChaCha8Rng) -> u32 {
    let mut three = (0..3).map(|_| rng.random_range(0..critical.len()));
    let first = three.next().expect("three are drawn");
    three.fold(first, |a, b| if critical[b] > critical[a] { b } else { a }) as u32
}
