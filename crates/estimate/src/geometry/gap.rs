//! Access to a gap: an open cell between the capturing block and a block opposite.
//!
//! A cube in it has no clearance along the face's normal, and free space to the sides. In some
//! scenes it jams. In other scenes, the two blocks guide it. Calibration decides which
//! ([`Rates::passes_gaps`](crate::Rates::passes_gaps)).
use stochc_ir::{Cell, Face};

use crate::geometry::surroundings::aside;

/// Returns the cells next to an open cell, perpendicular to `direction`, above the ground. The open
/// cell is a passable gap only if these cells are empty. The ground does not matter, because it
/// causes no jams.
pub fn beside_gap(cell: Cell, direction: Face) -> impl Iterator<Item = Cell> {
    let beside = aside(direction).filter_map(move |face| cell.across(face));
    beside.filter(|beside| beside.z >= 1)
}

/// Returns cubes of size two, each by its low corner. From each of these cubes, a block can slide
/// into the gap `cell`. A cube contains one of the cells [`beside_gap`], but not the gap.
pub fn gap_entrances(cell: Cell, direction: Face) -> impl Iterator<Item = Cell> {
    let pairs = aside(direction).flat_map(move |out| {
        let edges = aside(direction).filter(move |edge| *edge != out && *edge != out.opposite());
        edges.map(move |edge| (out, edge))
    });
    let lows = pairs.flat_map(move |(out, edge)| {
        [direction, direction.opposite()].map(|along| entrance(cell, out, edge, along))
    });
    lows.flatten().filter(|low| low.z >= 1)
}

/// Returns the low corner of a cube of size two. The cube contains the neighbour of `cell` in the
/// direction `out`. From there, it extends in the directions `out`, `edge` and `along`.
fn entrance(cell: Cell, out: Face, edge: Face, along: Face) -> Option<Cell> {
    let [first, edge, along] = [out, edge, along].map(Face::normal);
    let low = |axis: usize| first[axis] + (first[axis] + edge[axis] + along[axis]).min(0);
    cell.offset([0, 1, 2].map(low))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn cubes_stand_beside_the_cell() {
        let cell = Cell::new(3, -2, 9);
        for direction in Face::ALL {
            let beside: Vec<Cell> = beside_gap(cell, direction).collect();
            let mut seen = BTreeSet::new();
            for low in gap_entrances(cell, direction) {
                let steps = || 0..2;
                let cube: BTreeSet<Cell> = steps()
                    .flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])))
                    .map(|by| low.offset(by).expect("no number overflows"))
                    .collect();
                assert!(!cube.contains(&cell), "{direction:?}");
                let held = beside.iter().filter(|cell| cube.contains(cell));
                assert_eq!(held.count(), 1, "{direction:?}");
                seen.insert(low);
            }
            assert_eq!((beside.len(), seen.len()), (4, 16), "{direction:?}");
        }
        // On the ground there is no access from below.
        let low = gap_entrances(Cell::new(0, 0, 1), Face::East);
        assert_eq!(low.count(), 8);
    }
}
