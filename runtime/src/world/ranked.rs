//! Sets of numbers that know their k-th member.
use serde::{Deserialize, Serialize};
use wide::i32x4;

/// Children of a node.
const FANOUT: usize = 16;

/// For each child of a node, the members in those before it.
type Node = [[i32; 4]; FANOUT / 4];

/// The numbers of the children.
const NUMBERS: Node = [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11], [12, 13, 14, 15]];

/// A set of some of the numbers 0 to n: one bit each, below a tree of counts.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Vec<u64>", into = "Vec<u64>")]
pub(super) struct RankedSet {
    words: Vec<u64>,
    /// From the words up.
    levels: Vec<Vec<Node>>,
    len: u32,
}

impl From<Vec<u64>> for RankedSet {
    fn from(words: Vec<u64>) -> RankedSet {
        RankedSet::of(words)
    }
}

impl From<RankedSet> for Vec<u64> {
    fn from(set: RankedSet) -> Vec<u64> {
        set.words
    }
}

impl RankedSet {
    /// None of `n` numbers.
    pub fn empty(n: usize) -> RankedSet {
        RankedSet::of(vec![0; n.div_ceil(64)])
    }

    /// All of `n` numbers.
    pub fn full(n: usize) -> RankedSet {
        let mut words = vec![u64::MAX; n.div_ceil(64)];
        if let Some(last) = words.last_mut().filter(|_| !n.is_multiple_of(64)) {
            *last >>= 64 - n % 64;
        }
        RankedSet::of(words)
    }

    fn of(words: Vec<u64>) -> RankedSet {
        let mut counts: Vec<i32> = words.iter().map(|word| word.count_ones() as i32).collect();
        let mut levels = Vec::new();
        while counts.len() > 1 || levels.is_empty() {
            let mut sums = Vec::with_capacity(counts.len().div_ceil(FANOUT));
            let node = |of: &[i32]| {
                let mut sum = 0;
                let before: [i32; FANOUT] = std::array::from_fn(|child| {
                    let before = sum;
                    sum += of.get(child).unwrap_or(&0);
                    before
                });
                sums.push(sum);
                std::array::from_fn(|i| std::array::from_fn(|child| before[4 * i + child]))
            };
            let nodes: Vec<Node> = counts.chunks(FANOUT).map(node).collect();
            counts = sums;
            levels.push(nodes);
        }
        let len = counts.first().map_or(0, |count| *count as u32);
        RankedSet { words, levels, len }
    }

    /// How many members it has.
    pub fn len(&self) -> u32 {
        self.len
    }

    #[inline]
    pub fn contains(&self, number: usize) -> bool {
        self.words[number / 64] & (1 << (number % 64)) != 0
    }

    #[inline]
    pub fn insert(&mut self, number: usize) {
        if !self.contains(number) {
            self.len += 1;
            self.flip(number, 1);
        }
    }

    #[inline]
    pub fn remove(&mut self, number: usize) {
        if self.contains(number) {
            self.len -= 1;
            self.flip(number, -1);
        }
    }

    fn flip(&mut self, number: usize, change: i32) {
        self.words[number / 64] ^= 1 << (number % 64);
        let mut at = number / 64;
        let change = i32x4::splat(change);
        for level in &mut self.levels {
            let changed = i32x4::splat((at % FANOUT) as i32);
            at /= FANOUT;
            // All sixteen, so that it takes no branch.
            for (four, numbers) in level[at].iter_mut().zip(NUMBERS) {
                let is_after = i32x4::new(numbers).simd_gt(changed);
                *four = (i32x4::new(*four) + (change & is_after)).to_array();
            }
        }
    }

    /// The member before which there are `rank` others, fewer than all.
    #[inline]
    pub fn select(&self, rank: u32) -> usize {
        let (mut at, mut rank) = (0, rank as i32);
        for level in self.levels.iter().rev() {
            let node = &level[at];
            let wanted = i32x4::splat(rank);
            let is_behind = |i: usize| i32x4::new(node[i]).simd_gt(wanted).to_bitmask();
            let behind = is_behind(0) | is_behind(1) << 4 | is_behind(2) << 8 | is_behind(3) << 12;
            // Nothing is before the first.
            let child = ((behind | 1 << FANOUT).trailing_zeros() as usize - 1) % FANOUT;
            rank -= node[child / 4][child % 4];
            at = at * FANOUT + child;
        }
        64 * at + select_in(self.words[at], rank as u32) as usize
    }
}

/// The place of the bit before which `rank` others are set, fewer than all that are.
fn select_in(word: u64, rank: u32) -> u32 {
    const ONES: u64 = 0x0101_0101_0101_0101;
    // In each byte, its own bits; then also those of the bytes before it.
    let pairs = word - ((word >> 1) & (0x55 * ONES));
    let fours = (pairs & (0x33 * ONES)) + ((pairs >> 2) & (0x33 * ONES));
    let upto = ((fours + (fours >> 4)) & (0x0f * ONES)).wrapping_mul(ONES);
    // Bytes after which there still are not more than `rank`: their top bits stay set.
    let not_yet = ((u64::from(rank) * ONES) | (0x80 * ONES)) - upto;
    let shift = ((not_yet >> 7) & ONES).wrapping_mul(ONES) >> 56 << 3;
    let before = (upto << 8) >> shift & 0xff;
    let byte = usize::from((word >> shift) as u8);
    shift as u32 + u32::from(IN_BYTE[byte][(u64::from(rank) - before) as usize % 8])
}

/// Of each byte, the places of its set bits.
static IN_BYTE: [[u8; 8]; 256] = {
    let mut places = [[0; 8]; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut count, mut place) = (0, 0);
        while place < 8 {
            if byte >> place & 1 == 1 {
                places[byte][count] = place as u8;
                count += 1;
            }
            place += 1;
        }
        byte += 1;
    }
    places
};

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_word_knows_its_bits(word in prop_oneof![any::<u64>(), Just(u64::MAX), Just(1 << 63)]) {
            let bits = (0..64).filter(|bit| word & (1 << bit) != 0);
            for (rank, bit) in (0..).zip(bits) {
                prop_assert_eq!(select_in(word, rank), bit);
            }
        }

        #[test]
        fn the_set_is_that_of_the_library(
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
    fn a_set_of_no_numbers_is_empty() {
        assert_eq!(
            (RankedSet::empty(0).len(), RankedSet::full(0).len()),
            (0, 0)
        );
    }
}
