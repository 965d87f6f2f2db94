//! How blocks come into a gap: an open cell between the block that captures and one ahead of it.
//!
//! There a cube has no clearance along the face's normal. In some scenes it jams, in others the two blocks guide it; which of the two, is
//! measured ([`Rates::passes_gaps`](crate::Rates::passes_gaps)).
use stochc_ir::{Cell, Face};

use crate::neighbourhood::shifted;
use crate::surroundings::aside;

/// A place from which a block slides into a gap at right angles to the face's normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GapEntrance {
    /// The low corner of a cube of two sides before the gap.
    pub low: Cell,
    /// The cell beside the open one that has to be empty as well, so that the gap is narrow in one direction only.
    pub beside: Cell,
}

/// All entrances, above the ground, of the open cell to which `way` leads.
pub fn gap_entrances(cell: Cell, way: Face) -> impl Iterator<Item = GapEntrance> {
    let pairs = aside(way).flat_map(move |out| {
        let edges = aside(way).filter(move |edge| *edge != out && *edge != out.opposite());
        edges.map(move |edge| (out, edge))
    });
    let entrances = pairs.flat_map(move |(out, edge)| {
        [way, way.opposite()].map(|along| entrance(cell, out, edge, along))
    });
    entrances
        .flatten()
        .filter(|entrance| entrance.low.z >= 1 && entrance.beside.z >= 1)
}

/// The cube begins a step out of the cell and reaches another one out, and one along each of two other directions.
fn entrance(cell: Cell, out: Face, edge: Face, along: Face) -> Option<GapEntrance> {
    let [first, edge, along] = [out, edge, along].map(Face::normal);
    let low =
        std::array::from_fn(|axis| first[axis] + (first[axis] + edge[axis] + along[axis]).min(0));
    Some(GapEntrance {
        low: shifted(cell, low)?,
        beside: shifted(cell, edge)?,
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn cubes_stand_before_the_cell_and_its_neighbour() {
        let cell = Cell::new(3, -2, 9);
        for way in Face::ALL {
            let mut seen = BTreeSet::new();
            for GapEntrance { low, beside } in gap_entrances(cell, way) {
                let steps = || 0..2;
                let cube: BTreeSet<Cell> = steps()
                    .flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])))
                    .map(|by| shifted(low, by).unwrap())
                    .collect();
                assert!(!cube.contains(&cell) && !cube.contains(&beside), "{way:?}");
                let before = |cell: Cell| {
                    let near = Face::ALL.into_iter().filter_map(|face| cell.across(face));
                    let mut before: Vec<Cell> = near.filter(|near| cube.contains(near)).collect();
                    assert_eq!(before.len(), 1, "{way:?}");
                    before.remove(0)
                };
                let offset = |a: Cell, b: Cell| [b.x - a.x, b.y - a.y, b.z - a.z];
                let out = offset(cell, before(cell));
                assert_eq!(offset(beside, before(beside)), out);
                let along = |by: [i32; 3]| {
                    let normal = way.normal();
                    (0..3).map(|axis| by[axis] * normal[axis]).sum::<i32>()
                };
                assert_eq!((along(out), along(offset(cell, beside))), (0, 0));
                seen.insert((low, beside));
            }
            assert_eq!(seen.len(), 16, "{way:?}");
        }
        // On the ground nobody comes from below, and none stands there.
        let low = gap_entrances(Cell::new(0, 0, 1), Face::East);
        assert_eq!(low.count(), 10);
    }
}
