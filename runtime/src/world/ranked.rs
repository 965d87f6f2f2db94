//! Ordered sets of integers with selection of the k-th member.
use serde::{Deserialize, Serialize};
use wide::{i8x16, i16x8, i32x4};

/// Children of a node.
const FANOUT: usize = 16;

/// Numbers per leaf.
const LEAF: usize = 8 * FANOUT;

/// Levels above the leaves whose counts fit in an `i16`.
const LOW: usize = 2;

/// Node with the number of members before each child.
trait Node {
    /// Returns a node whose children have these counts.
    fn of(counts: &[u32]) -> Self;

    /// Returns the child with the member of this rank, and the rank within the child.
    fn find(&self, rank: u32) -> (usize, u32);

    /// Adds or subtracts one member of a child.
    fn count<const IS_MORE: bool>(&mut self, child: usize);
}

/// Compares all sixteen children at once, without branches.
macro_rules! node {
    ($node:ident, $count:ty, $vector:ty, $lanes:literal) => {
        #[derive(Clone, Copy, Debug)]
        struct $node([[$count; $lanes]; FANOUT / $lanes]);

        impl Node for $node {
            fn of(counts: &[u32]) -> $node {
                let mut sum = 0;
                $node(std::array::from_fn(|i| {
                    std::array::from_fn(|lane| {
                        let before = sum;
                        sum += counts.get($lanes * i + lane).unwrap_or(&0);
                        before as $count
                    })
                }))
            }

            #[inline]
            fn find(&self, rank: u32) -> (usize, u32) {
                let wanted = <$vector>::splat(rank as $count);
                let mut behind = 1 << FANOUT;
                for (i, before) in self.0.iter().enumerate() {
                    let is_behind = <$vector>::new(*before).simd_gt(wanted);
                    behind |= is_behind.to_bitmask() << ($lanes * i);
                }
                // The first child has no members before it.
                let child = (behind.trailing_zeros() as usize - 1) % FANOUT;
                (child, rank - self.0.as_flattened()[child] as u32)
            }

            #[inline]
            fn count<const IS_MORE: bool>(&mut self, child: usize) {
                /// For each child, -1 for all later children.
                static AFTER: [[[$count; $lanes]; FANOUT / $lanes]; FANOUT] = {
                    let mut after = [[[0; $lanes]; FANOUT / $lanes]; FANOUT];
                    let mut i = 0;
                    while i < FANOUT * FANOUT {
                        let (child, other) = (i / FANOUT, i % FANOUT);
                        if other > child {
                            after[child][other / $lanes][other % $lanes] = -1;
                        }
                        i += 1;
                    }
                    after
                };
                for (before, after) in self.0.iter_mut().zip(&AFTER[child % FANOUT]) {
                    let (was, after) = (<$vector>::new(*before), <$vector>::new(*after));
                    let is = if IS_MORE { was - after } else { was + after };
                    *before = is.to_array();
                }
            }
        }
    };
}

node!(Bytes, i8, i8x16, 16);
node!(Low, i16, i16x8, 8);
node!(High, i32, i32x4, 4);

/// Members of a row of numbers, one bit each. For each byte, the number of members in earlier
/// bytes.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    before: Bytes,
    bytes: [u8; FANOUT],
}

impl Leaf {
    /// Adds or removes a number of the row. Returns whether this changes the set.
    #[inline]
    fn put<const IS_IN: bool>(&mut self, number: usize) -> bool {
        let byte = number / 8 % FANOUT;
        let bit = 1 << (number % 8);
        let is_new = (self.bytes[byte] & bit != 0) != IS_IN;
        if is_new {
            self.bytes[byte] ^= bit;
            self.before.count::<IS_IN>(byte);
        }
        is_new
    }
}

/// Subset of the numbers 0 to n: leaves below a tree of counts of the smallest possible types.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Vec<u128>", into = "Vec<u128>")]
pub(super) struct RankedSet {
    leaves: Vec<Leaf>,
    /// Levels from the leaves up.
    low: Vec<Vec<Low>>,
    high: Vec<Vec<High>>,
    len: u32,
}

impl From<Vec<u128>> for RankedSet {
    fn from(leaves: Vec<u128>) -> RankedSet {
        RankedSet::new(&leaves)
    }
}

impl From<RankedSet> for Vec<u128> {
    fn from(set: RankedSet) -> Vec<u128> {
        let leaves = set.leaves.iter();
        leaves.map(|leaf| u128::from_le_bytes(leaf.bytes)).collect()
    }
}

impl RankedSet {
    /// Returns the empty set of `n` numbers.
    pub fn empty(n: usize) -> RankedSet {
        RankedSet::new(&vec![0; n.div_ceil(LEAF)])
    }

    /// Returns the full set of `n` numbers.
    pub fn full(n: usize) -> RankedSet {
        let mut leaves = vec![u128::MAX; n.div_ceil(LEAF)];
        if let Some(last) = leaves.last_mut().filter(|_| !n.is_multiple_of(LEAF)) {
            *last >>= LEAF - n % LEAF;
        }
        RankedSet::new(&leaves)
    }

    fn new(leaves: &[u128]) -> RankedSet {
        let mut counts: Vec<u32> = leaves.iter().map(|leaf| leaf.count_ones()).collect();
        let leaf = |leaf: &u128| {
            let bytes = leaf.to_le_bytes();
            Leaf {
                before: Bytes::of(&bytes.map(u8::count_ones)),
                bytes,
            }
        };
        let (mut low, mut high) = (Vec::new(), Vec::new());
        while counts.len() > 1 {
            match low.len() {
                0..LOW => low.push(level(&mut counts)),
                LOW.. => high.push(level(&mut counts)),
            }
        }
        RankedSet {
            leaves: leaves.iter().map(leaf).collect(),
            low,
            high,
            len: counts.first().copied().unwrap_or(0),
        }
    }

    /// Returns the number of members.
    pub fn len(&self) -> u32 {
        self.len
    }

    #[inline]
    pub fn contains(&self, number: usize) -> bool {
        self.leaves[number / LEAF].bytes[number / 8 % FANOUT] & (1 << (number % 8)) != 0
    }

    #[inline]
    pub fn insert(&mut self, number: usize) {
        if self.leaves[number / LEAF].put::<true>(number % LEAF) {
            self.len += 1;
            self.count::<true>(number / LEAF);
        }
    }

    #[inline]
    pub fn remove(&mut self, number: usize) {
        if self.leaves[number / LEAF].put::<false>(number % LEAF) {
            self.len -= 1;
            self.count::<false>(number / LEAF);
        }
    }

    /// Adds or subtracts one member of a leaf.
    #[inline]
    fn count<const IS_MORE: bool>(&mut self, leaf: usize) {
        let mut at = leaf;
        for level in &mut self.low {
            level[at / FANOUT].count::<IS_MORE>(at % FANOUT);
            at /= FANOUT;
        }
        for level in &mut self.high {
            level[at / FANOUT].count::<IS_MORE>(at % FANOUT);
            at /= FANOUT;
        }
    }

    /// Returns the member of a rank, which must be below the number of members.
    #[inline]
    pub fn select(&self, mut rank: u32) -> usize {
        let mut at = 0;
        for level in self.high.iter().rev() {
            (at, rank) = below(level, at, rank);
        }
        for level in self.low.iter().rev() {
            (at, rank) = below(level, at, rank);
        }
        let leaf = &self.leaves[at];
        let (byte, rank) = leaf.before.find(rank);
        let place = IN_BYTE[usize::from(leaf.bytes[byte])][rank as usize % 8];
        LEAF * at + 8 * byte + usize::from(place)
    }
}

/// Returns the parents of nodes with these counts, and replaces the counts by the parents' counts.
fn level<N: Node>(counts: &mut Vec<u32>) -> Vec<N> {
    let nodes = counts.chunks(FANOUT).map(N::of).collect();
    *counts = (counts.chunks(FANOUT)).map(|of| of.iter().sum()).collect();
    nodes
}

/// Descends one level to the member of a rank. Returns the node and the rank within it.
#[inline]
fn below<N: Node>(level: &[N], at: usize, rank: u32) -> (usize, u32) {
    let (child, rank) = level[at].find(rank);
    (FANOUT * at + child, rank)
}

/// Positions of the set bits of each byte.
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
