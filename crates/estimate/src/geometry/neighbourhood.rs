//! Occupancy of the cells around an open one.
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, offsets_within};

/// Largest distance of a blocking cell from the open cell along an axis \[cells\].
pub const SIGHT: i32 = 2;

/// Set of blocked cells within [`SIGHT`] along each axis. Blocks and the ground count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Neighbourhood(u128);

/// For a cell in each of the lowest layers, the part of its neighbourhood that the ground blocks.
static ON_GROUND: LazyLock<[Neighbourhood; EDGE as usize]> = LazyLock::new(|| {
    std::array::from_fn(|layer| {
        let layer = layer as i32 - SIGHT;
        Neighbourhood::from_cells(all().filter(|[.., z]| layer + z < 1))
    })
});

/// Cells in the layer of the open cell.
static IN_PLANE: LazyLock<Neighbourhood> =
    LazyLock::new(|| Neighbourhood::from_cells(all().filter(|[.., z]| *z == 0)));

/// Number of cells along each edge.
const EDGE: i32 = 2 * SIGHT + 1;

/// Number of cells of a neighbourhood.
pub(crate) const CELLS: usize = EDGE.pow(3) as usize;

impl Neighbourhood {
    /// Neighbourhood of a cell high above the ground, without blocks.
    pub const EMPTY: Neighbourhood = Neighbourhood(0);

    /// Returns the neighbourhood of a cell. Calls `is_full` for cells above the plate. All cells
    /// below are ground.
    pub fn new(cell: Cell, is_full: impl Fn(Cell) -> bool) -> Neighbourhood {
        Neighbourhood::around(Neighbourhood::from_cells(all()), cell, is_full)
    }

    /// Returns the part of a cell's neighbourhood that lies in `which`. Calls `is_full` only for
    /// the cells of `which`.
    pub(crate) fn around(
        which: Neighbourhood,
        cell: Cell,
        is_full: impl Fn(Cell) -> bool,
    ) -> Neighbourhood {
        let mut found = Neighbourhood::on_ground(cell).within(which);
        for index in which.without(found).indices() {
            let offset = offset(index);
            if cell.offset(offset).is_some_and(&is_full) {
                found.block(offset);
            }
        }
        found
    }

    /// Returns the neighbourhood of a cell above the plate without blocks.
    pub fn on_ground(cell: Cell) -> Neighbourhood {
        let layer = cell.z.clamp(-SIGHT, SIGHT + 1) + SIGHT;
        let low = ON_GROUND.get(layer as usize);
        low.copied().unwrap_or(Neighbourhood::EMPTY)
    }

    /// Returns the cells that can affect a face in a scene. In a planar world, the table below all
    /// blocks has no effect.
    #[must_use]
    pub fn in_world_of(self, scene: &Scene) -> Neighbourhood {
        match scene.planar {
            Some(_) => self.within(*IN_PLANE),
            None => self,
        }
    }

    /// Blocks a cell at an offset of at most [`SIGHT`].
    pub fn block(&mut self, offset: [i32; 3]) {
        self.0 |= bit(offset);
    }

    /// Blocks or unblocks a cell at an offset of at most [`SIGHT`].
    pub fn set(&mut self, offset: [i32; 3], is_blocked: bool) {
        if is_blocked {
            self.block(offset)
        } else {
            self.0 &= !bit(offset)
        }
    }

    /// Returns whether a cell at an offset of at most [`SIGHT`] is blocked.
    pub fn is_blocked(self, offset: [i32; 3]) -> bool {
        self.0 & bit(offset) != 0
    }

    /// Returns the set of cells at these offsets.
    pub(crate) fn from_cells(offsets: impl IntoIterator<Item = [i32; 3]>) -> Neighbourhood {
        let mut found = Neighbourhood::EMPTY;
        offsets.into_iter().for_each(|offset| found.block(offset));
        found
    }

    /// Returns whether the two sets have a common cell.
    pub(crate) fn meets(self, other: Neighbourhood) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns the indices of the blocked cells, below [`CELLS`].
    pub(crate) fn indices(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let index = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            (index < CELLS).then_some(index)
        })
    }

    /// Returns the union of two sets.
    #[must_use]
    pub fn and(self, other: Neighbourhood) -> Neighbourhood {
        Neighbourhood(self.0 | other.0)
    }

    #[must_use]
    fn without(self, other: Neighbourhood) -> Neighbourhood {
        Neighbourhood(self.0 & !other.0)
    }

    /// Returns the intersection of two sets.
    #[must_use]
    pub fn within(self, other: Neighbourhood) -> Neighbourhood {
        Neighbourhood(self.0 & other.0)
    }
}

/// Returns the offsets of all cells of a neighbourhood.
pub(crate) fn all() -> impl Iterator<Item = [i32; 3]> {
    offsets_within(SIGHT)
}

fn bit(offset: [i32; 3]) -> u128 {
    1 << index(offset)
}

/// Returns the index of a cell.
pub(crate) fn index(offset: [i32; 3]) -> usize {
    let [x, y, z] = offset.map(|step| step + SIGHT);
    (x + EDGE * (y + EDGE * z)) as usize
}

fn offset(index: usize) -> [i32; 3] {
    let index = index as i32;
    [index, index / EDGE, index / (EDGE * EDGE)].map(|part| part % EDGE - SIGHT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_has_its_own_bit_and_the_ground_is_blocked() {
        for z in 1..5 {
            let cell = Cell::new(7, -3, z);
            let is_full = |near: Cell| (near.x + 2 * near.y + 3 * near.z) % 5 == 0;
            let found = Neighbourhood::new(cell, is_full);
            for [dx, dy, dz] in all() {
                let near = Cell::new(7 + dx, dy - 3, z + dz);
                let expected = near.z < 1 || is_full(near);
                assert_eq!(found.is_blocked([dx, dy, dz]), expected, "{near}");
                assert_eq!(offset(index([dx, dy, dz])), [dx, dy, dz]);
            }
            let some = Neighbourhood::from_cells(all().filter(|[dx, ..]| *dx > 0));
            let part = Neighbourhood::around(some, cell, |near| {
                assert!(near.x > 7, "cells out of interest must not be queried");
                is_full(near)
            });
            assert_eq!(part, found.within(some));
        }
        let near = Neighbourhood::new(Cell::new(0, 0, 1), |near| near.x == 1);
        let mut scene = crate::Rates::shipped()[0].scene.clone();
        assert_eq!(near.in_world_of(&scene), near);
        scene.planar = Some(stochc_ir::scene::Planar { friction: None });
        let in_plane = near.in_world_of(&scene);
        assert!(in_plane.is_blocked([1, 2, 0]) && !in_plane.is_blocked([0, 0, -1]));
        let edge = Cell::new(i32::MAX, i32::MIN, i32::MAX);
        let found = Neighbourhood::new(edge, |_| true);
        assert!(found.is_blocked([-1, 1, -1]) && !found.is_blocked([1, 0, 0]));
    }
}
