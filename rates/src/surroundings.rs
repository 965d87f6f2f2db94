//! What is around an open face, cell by cell.
use stochc_ir::{Cell, Face};

use crate::law::Surroundings;
use crate::neighbourhood::Neighbourhood;
use crate::reach::unobstructed;

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
    let aside = || (Face::ALL.into_iter()).filter(|face| *face != way && *face != way.opposite());
    let beside = |[x, y, z]: [i32; 3]| {
        aside().any(|face| {
            let [dx, dy, dz] = face.normal();
            near.is_blocked([x + dx, y + dy, z + dz])
        })
    };
    Surroundings {
        open: unobstructed(way, near),
        density: 1.0,
        free: 1.0,
        beside: beside([0; 3]),
        beside_parent: beside(way.opposite().normal()),
        rival: aside().any(|face| cell.across(face).is_some_and(&is_open)),
        cold: false,
    }
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
}
