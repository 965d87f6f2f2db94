//! Ordered sets of integers with selection of the k-th member.
use serde::{Deserialize, Serialize};

/// Subset of the numbers 0 to n, with a Fenwick tree of its members.
///
/// # Source
///
/// P. M. Fenwick, Software: Practice and Experience 24 (1994), 327-336.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Vec<u64>", into = "Vec<u64>")]
pub(super) struct RankedSet {
    /// One bit for each number: whether the set contains the number.
    words: Vec<u64>,
    /// Entry i counts the members in the 2^k words before word i, where k is the lowest bit of i.
    counts: Vec<u32>,
    len: u32,
}

impl From<Vec<u64>> for RankedSet {
    fn from(words: Vec<u64>) -> RankedSet {
        let mut counts = vec![0; words.len() + 1];
        let mut len = 0;
        for (i, word) in (1..).zip(&words) {
            counts[i] += word.count_ones();
            len += word.count_ones();
            let above = i + (i & i.wrapping_neg());
            if above < counts.len() {
                counts[above] += counts[i];
            }
        }
        RankedSet { words, counts, len }
    }
}

impl From<RankedSet> for Vec<u64> {
    fn from(set: RankedSet) -> Vec<u64> {
        set.words
    }
}

impl RankedSet {
    pub fn empty(n: usize) -> RankedSet {
        vec![0; n.div_ceil(64)].into()
    }

    pub fn full(n: usize) -> RankedSet {
        let mut words = vec![u64::MAX; n.div_ceil(64)];
        if let Some(last) = words.last_mut().filter(|_| !n.is_multiple_of(64)) {
            *last >>= 64 - n % 64;
        }
        words.into()
    }

    pub fn len(&self) -> u32 {
        self.len
    }

    pub fn contains(&self, number: usize) -> bool {
        self.words[number / 64] >> (number % 64) & 1 == 1
    }

    pub fn insert(&mut self, number: usize) {
        if !self.contains(number) {
            self.len += 1;
            self.flip(number, |count| count + 1);
        }
    }

    pub fn remove(&mut self, number: usize) {
        if self.contains(number) {
            self.len -= 1;
            self.flip(number, |count| count - 1);
        }
    }

    fn flip(&mut self, number: usize, counted: impl Fn(u32) -> u32) {
        self.words[number / 64] ^= 1 << (number % 64);
        let mut at = number / 64 + 1;
        while let Some(count) = self.counts.get_mut(at) {
            *count = counted(*count);
            at += at & at.wrapping_neg();
        }
    }

    /// Returns the member with exactly `rank` smaller members. There must be more than `rank`
    /// members.
    pub fn select(&self, mut rank: u32) -> usize {
        let mut before = 0;
        let mut step = 1 << self.words.len().ilog2();
        while step > 0 {
            // Without branches, because they would be unpredictable.
            let count = self.counts.get(before + step);
            let count = count.copied().unwrap_or(u32::MAX);
            let is_before = count <= rank;
            rank -= count * u32::from(is_before);
            before += step * usize::from(is_before);
            step /= 2;
        }
        64 * before + select_bit(self.words[before], rank)
    }
}

/// Returns the index of the set bit with exactly `rank` set bits below it. There must be more than
/// `rank` set bits.
fn select_bit(word: u64, mut rank: u32) -> usize {
    let mut before = 0;
    for width in [32, 16, 8] {
        let low = word >> before & ((1 << width) - 1);
        let is_before = low.count_ones() <= rank;
        rank -= low.count_ones() * u32::from(is_before);
        before += width * usize::from(is_before);
    }
    let mut rest = word >> before;
    for _ in 0..rank {
        rest &= rest - 1;
    }
    before + rest.trailing_zeros() as usize
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_set_agrees_with_the_standard_library(
            n in 1usize..40_000,
            is_full: bool,
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>()), 0..300),
        ) {
            let (mut ranked, mut plain) = if is_full {
                (RankedSet::full(n), (0..n).collect())
            } else {
                (RankedSet::empty(n), BTreeSet::new())
            };
            for (which, is_in) in changes {
                let number = which.index(n);
                if is_in {
                    ranked.insert(number);
                    plain.insert(number);
                } else {
                    ranked.remove(number);
                    plain.remove(&number);
                }
                prop_assert_eq!(ranked.contains(number), is_in);
            }
            prop_assert_eq!(ranked.len() as usize, plain.len());
            for (rank, member) in plain.into_iter().enumerate().step_by(7) {
                prop_assert_eq!(ranked.select(rank as u32), member);
            }
        }
    }

    #[test]
    fn an_empty_set_is_empty() {
        assert_eq!(
            (RankedSet::empty(0).len(), RankedSet::full(0).len()),
            (0, 0)
        );
    }
}
