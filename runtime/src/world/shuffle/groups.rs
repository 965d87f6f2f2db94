//! Free blocks that have bonded to each other.
use serde::{Deserialize, Serialize};

/// Sets of blocks that only grow together, and the size of the largest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DisjointSets {
    /// Of each block another one of its set, or itself: one for all.
    towards: Vec<u32>,
    /// Blocks in the set of such a one.
    sizes: Vec<u32>,
    largest: u32,
}

impl DisjointSets {
    /// Blocks of which none are bonded.
    pub fn new(count: u32) -> DisjointSets {
        DisjointSets {
            towards: (0..count).collect(),
            sizes: vec![1; count as usize],
            largest: 1,
        }
    }

    /// Blocks of the largest set.
    pub fn largest(&self) -> u32 {
        self.largest
    }

    /// Bonds two blocks, and with them their sets.
    pub fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.find(one), self.find(other));
        if one != other {
            let (large, small) = if self.sizes[one] < self.sizes[other] {
                (other, one)
            } else {
                (one, other)
            };
            self.towards[small] = large as u32;
            self.sizes[large] += self.sizes[small];
            self.largest = self.largest.max(self.sizes[large]);
        }
    }

    fn find(&self, block: u32) -> usize {
        let mut at = block as usize;
        while self.towards[at] as usize != at {
            at = self.towards[at] as usize;
        }
        at
    }
}
