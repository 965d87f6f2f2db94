//! Groups of bonded free blocks.
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DisjointSets {
    /// Parent of each block: another block of its set, or itself for the root.
    towards: Vec<u32>,
    sizes: Vec<u32>,
    largest: u32,
}

impl DisjointSets {
    /// Returns sets of one block each.
    pub fn new(count: u32) -> DisjointSets {
        DisjointSets {
            towards: (0..count).collect(),
            sizes: vec![1; count as usize],
            largest: 1,
        }
    }

    pub fn largest(&self) -> u32 {
        self.largest
    }

    /// Merges the sets of two blocks.
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
