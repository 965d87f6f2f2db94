//! What is around an open face, cell by cell.
use stochc_ir::{Cell, Face};

use crate::law::Surroundings;
use crate::reach::unobstructed;

/// What is around the face that is open towards `cell` in the direction `way`: full cells above the plate, as `is_full` says, the
/// ground below, and cells that another face of the same direction is open to, as `is_open` says.
///
/// The gas is left as it is in the mean; see [`Rates::surroundings`](crate::Rates::surroundings).
pub fn around(
    cell: Cell,
    way: Face,
    is_full: impl Fn(Cell) -> bool,
    is_open: impl Fn(Cell) -> bool,
) -> Surroundings {
    let is_blocked = |cell: Option<Cell>| cell.is_some_and(|cell| cell.z < 1 || is_full(cell));
    let beside = |cell: Option<Cell>| {
        cell.is_some_and(|cell| ring(way).any(|(one, other)| is_blocked(step(cell, one, other))))
    };
    Surroundings {
        open: unobstructed(cell, way, &is_full),
        density: 1.0,
        free: 1.0,
        beside: beside(Some(cell)),
        beside_parent: beside(cell.across(way.opposite())),
        rival: ring(way)
            .filter(|(_, other)| other.is_none())
            .any(|(one, _)| cell.across(one).is_some_and(&is_open)),
        cold: false,
    }
}

/// The eight neighbours in the plane across a direction: across a face, or across two.
fn ring(way: Face) -> impl Iterator<Item = (Face, Option<Face>)> {
    let aside = move || {
        Face::ALL
            .into_iter()
            .filter(move |face| *face != way && *face != way.opposite())
    };
    let across_edges = move || {
        // Each edge once: a face of the first axis with one of the second.
        aside().flat_map(move |one| {
            let others = aside().filter(move |other| (*other as usize / 2) > (one as usize / 2));
            others.map(move |other| (one, Some(other)))
        })
    };
    aside().map(|face| (face, None)).chain(across_edges())
}

fn step(cell: Cell, one: Face, other: Option<Face>) -> Option<Cell> {
    let next = cell.across(one)?;
    other.map_or(Some(next), |other| next.across(other))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_eight_cells_in_a_plane() {
        for way in Face::ALL {
            let mut cells: Vec<_> = ring(way)
                .map(|(one, other)| step(Cell::new(0, 0, 9), one, other).expect("there is one"))
                .collect();
            cells.sort_unstable();
            cells.dedup();
            assert_eq!(cells.len(), 8);
            let normal = way.normal();
            for cell in cells {
                let offset = [cell.x, cell.y, cell.z - 9];
                let along: i32 = offset.iter().zip(normal).map(|(a, b)| a * b).sum();
                assert_eq!(along, 0);
            }
        }
    }

    #[test]
    fn a_face_of_the_plate_has_ground_beside_its_parent() {
        let seen = around(Cell::new(0, 0, 1), Face::Up, |_| false, |_| false);
        assert!(seen.beside_parent && !seen.beside && !seen.rival);
        let tower = |cell: Cell| (cell.x, cell.y) == (0, 0) && cell.z < 5;
        let seen = around(Cell::new(0, 0, 5), Face::Up, tower, |_| false);
        assert!(!seen.beside_parent && !seen.beside);
        let seen = around(Cell::new(1, 0, 1), Face::East, tower, |cell| {
            cell == Cell::new(1, 1, 1)
        });
        assert!(seen.beside && seen.rival);
    }
}
