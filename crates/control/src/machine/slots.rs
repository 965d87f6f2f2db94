//! Anchored blocks in contiguous memory, found by body.
use serde::{Deserialize, Serialize};

use super::block::StructureBlock;
use super::block_slot::BlockSlot;
use super::index::Index;
use crate::body::Body;

/// Below one slot per `FEW` bodies, use a comparison sort.
const FEW: usize = 16;

/// Anchored blocks. The plate's blocks come first, in the order of their cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Slots<M> {
    blocks: Vec<Option<StructureBlock<M>>>,
    vacant: Vec<BlockSlot>,
    seeds: usize,
    /// Slot of each formerly free block, by number. The list may omit blocks at its end that were
    /// never anchored.
    of_free: Vec<BlockSlot>,
}

impl<M> Slots<M> {
    /// Returns the blocks of the plate in the order of their cells, with space for `others` further
    /// blocks.
    pub fn new(seeds: impl Iterator<Item = StructureBlock<M>>, others: usize) -> Slots<M> {
        let mut blocks: Vec<_> = seeds.map(Some).collect();
        blocks.reserve_exact(others);
        Slots {
            seeds: blocks.len(),
            blocks,
            vacant: Vec::new(),
            of_free: Vec::new(),
        }
    }

    pub fn count(&self) -> usize {
        self.blocks.len() - self.vacant.len()
    }

    /// Returns the slot of a block, or `None` if it is not anchored.
    #[inline]
    pub fn find(&self, index: &Index, body: Body) -> Option<BlockSlot> {
        match body {
            Body::Seed(cell) => index.seed(cell),
            Body::Free(id) => {
                let slot = self.of_free.get(id as usize).copied();
                slot.filter(|slot| *slot != BlockSlot::NONE)
            }
        }
    }

    /// Sorts distinct slots by the order of their bodies.
    pub fn sort(&self, slots: &mut Vec<BlockSlot>) {
        let count = self.seeds + self.of_free.len();
        if slots.len() < count / FEW {
            slots.sort_unstable_by_key(|slot| self.rank(*slot));
            return;
        }
        // Ranks are distinct, so a counting sort works.
        let mut by_rank = vec![BlockSlot::NONE; count];
        for slot in &*slots {
            by_rank[self.rank(*slot)] = *slot;
        }
        slots.clear();
        slots.extend(by_rank.iter().filter(|slot| **slot != BlockSlot::NONE));
    }

    /// Returns the rank of a block among all bodies.
    fn rank(&self, slot: BlockSlot) -> usize {
        match self.get(slot).map(|block| block.body) {
            Some(Body::Free(id)) => self.seeds + id as usize,
            _ => slot.0 as usize,
        }
    }

    /// Returns the slot of a free block. Reserves a slot if the block has none.
    #[inline]
    pub fn reserve(&mut self, id: u32) -> BlockSlot {
        if self.of_free.len() <= id as usize {
            self.of_free.resize(id as usize + 1, BlockSlot::NONE);
        }
        let known = &mut self.of_free[id as usize];
        if *known == BlockSlot::NONE {
            let next = BlockSlot(self.blocks.len() as u32);
            *known = self.vacant.pop().unwrap_or(next);
        }
        *known
    }

    /// Puts a free block into its [reserved slot](Self::reserve).
    #[inline]
    pub fn put(&mut self, slot: BlockSlot, block: StructureBlock<M>) {
        match self.blocks.get_mut(slot.0 as usize) {
            Some(entry) => *entry = Some(block),
            None => self.blocks.push(Some(block)),
        }
    }

    /// Removes a formerly free block.
    pub fn remove(&mut self, slot: BlockSlot) {
        let Some(entry) = self.blocks.get_mut(slot.0 as usize) else {
            return;
        };
        let Some(block) = entry else { return };
        if let Body::Free(id) = block.body {
            self.of_free[id as usize] = BlockSlot::NONE;
        }
        *entry = None;
        self.vacant.push(slot);
    }

    #[inline]
    pub fn get(&self, slot: BlockSlot) -> Option<&StructureBlock<M>> {
        self.blocks.get(slot.0 as usize)?.as_ref()
    }

    #[inline]
    pub fn get_mut(&mut self, slot: BlockSlot) -> Option<&mut StructureBlock<M>> {
        self.blocks.get_mut(slot.0 as usize)?.as_mut()
    }

    /// Iterates over all blocks in the order of their bodies.
    pub fn iter(&self) -> impl Iterator<Item = &StructureBlock<M>> {
        let free = (self.of_free.iter()).filter_map(|slot| self.get(*slot));
        self.blocks[..self.seeds].iter().flatten().chain(free)
    }
}
