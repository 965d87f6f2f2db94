//! What is around an open face, cell by cell.
use std::sync::LazyLock;

use stochc_ir::{Cell, Face};

use crate::law::Surroundings;
use crate::neighbourhood::Neighbourhood;
use crate::reach::{in_reach, unobstructed};

/// What is around the face that is open towards `cell` in the direction `way`: blocked cells, and cells that another face of the same
/// direction is open to, as `is_open` says.
///
/// The gas is left as it is in the mean; see [`Rates::surroundings`](crate::Rates::surroundings).
pub fn around(
    cell: Cell,
    way: Face,
    near: Neighbourhood,
    is_open: impl Fn(Cell) -> bool,
) -> Surroundings {
    let beside = |of| beside(way, of).any(|offset| near.is_blocked(offset));
    Surroundings {
        open: unobstructed(way, near),
        density: 1.0,
        free: 1.0,
        beside: beside([0; 3]),
        beside_parent: beside(way.opposite().normal()),
        rival: aside(way).any(|face| cell.across(face).is_some_and(&is_open)),
        cold: false,
    }
}

/// The cells around the open one that [`around`] looks at, for a face of a direction.
pub fn feature_cells(way: Face) -> Neighbourhood {
    FEATURE_CELLS[way as usize]
}

static FEATURE_CELLS: LazyLock<[Neighbourhood; 6]> = LazyLock::new(|| {
    Face::ALL.map(|way| {
        let mut cells = in_reach(way);
        let parent = way.opposite().normal();
        let beside = beside(way, [0; 3]).chain(beside(way, parent));
        beside.for_each(|offset| cells.block(offset));
        cells
    })
});

/// The directions at right angles to another.
fn aside(way: Face) -> impl Iterator<Item = Face> {
    let others = Face::ALL.into_iter();
    others.filter(move |face| *face != way && *face != way.opposite())
}

/// The cells beside one, at right angles to a direction.
fn beside(way: Face, of: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    aside(way).map(move |face| {
        let step = face.normal();
        std::array::from_fn(|axis| of[axis] + step[axis])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_of_the_plate_has_ground_beside_its_parent() {
        let around = |cell, way, is_full: &dyn Fn(Cell) -> bool, is_open: &dyn Fn(Cell) -> bool| {
            around(cell, way, Neighbourhood::of(cell, is_full), is_open)
        };
        let seen = around(Cell::new(0, 0, 1), Face::Up, &|_| false, &|_| false);
        assert!(seen.beside_parent && !seen.beside && !seen.rival);
        let tower = |cell: Cell| (cell.x, cell.y) == (0, 0) && cell.z < 5;
        let seen = around(Cell::new(0, 0, 5), Face::Up, &tower, &|_| false);
        assert!(!seen.beside_parent && !seen.beside);
        let seen = around(Cell::new(1, 0, 1), Face::East, &tower, &|cell| {
            cell == Cell::new(1, 1, 1)
        });
        assert!(seen.beside && seen.rival);
    }
    #[test]
    fn no_other_cells_are_looked_at() {
        for way in Face::ALL {
            let all = crate::neighbourhood::all();
            let blocked = all.filter(|offset| !feature_cells(way).is_blocked(*offset));
            let mut near = Neighbourhood::EMPTY;
            blocked.for_each(|offset| near.block(offset));
            assert_ne!(near, Neighbourhood::EMPTY);
            let seen = |near| around(Cell::new(0, 0, 50), way, near, |_| false);
            assert_eq!(seen(near), seen(Neighbourhood::EMPTY), "{way:?}");
        }
    }
}
