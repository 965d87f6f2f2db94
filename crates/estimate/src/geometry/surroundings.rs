//! Surroundings of an open face, from the cells around it.
use std::sync::LazyLock;

use stochc_ir::{Cell, Face};

use crate::geometry::accessibility::{in_reach, unobstructed};
use crate::geometry::neighbourhood::Neighbourhood;
use crate::geometry::rivals::{Rivals, rivals};
use crate::waits::law::Surroundings;

/// Returns the surroundings of the face open to `cell` in a direction. `near` are the blocked
/// cells, and `open` returns the direction of the face open to a cell.
///
/// The density of free blocks is set to the mean. See
/// [`Rates::surroundings`](crate::Rates::surroundings).
pub fn around(
    cell: Cell,
    direction: Face,
    near: Neighbourhood,
    open: impl Fn(Cell) -> Option<Face>,
) -> Surroundings {
    Surroundings {
        rivals: rivals(cell, direction, open),
        ..blocked_around(cell, direction, near)
    }
}

/// Returns the surroundings without other open faces.
pub(crate) fn blocked_around(cell: Cell, direction: Face, near: Neighbourhood) -> Surroundings {
    let [of_cell, of_parent] = &FLANKS[direction as usize];
    let adjacent = |of: &Flanks| near.meets(of.adjacent);
    let corner = |of: &Flanks| near.meets(of.across_edge) && !adjacent(of);
    let [.., up] = direction.normal();
    let is_block_ahead = near.is_blocked(direction.normal()) && cell.z + up >= 1;
    Surroundings {
        direction,
        open: unobstructed(direction, near),
        density: 1.0,
        free: 1.0,
        adjacent: adjacent(of_cell),
        adjacent_parent: adjacent(of_parent),
        corner: corner(of_cell),
        corner_parent: corner(of_parent),
        near_parent: near.meets(of_parent.two_away)
            && !near.meets(of_parent.adjacent.and(of_parent.across_edge)),
        ahead: is_block_ahead && !adjacent(of_cell),
        rivals: Rivals::default(),
        cold: false,
    }
}

/// Cells around a cell, perpendicular to a direction.
struct Flanks {
    adjacent: Neighbourhood,
    across_edge: Neighbourhood,
    two_away: Neighbourhood,
}

/// Cells around the open cell and around the capturing block, by direction of the face.
static FLANKS: LazyLock<[[Flanks; 2]; 6]> = LazyLock::new(|| {
    Face::ALL.map(|direction| {
        [[0; 3], direction.opposite().normal()].map(|of| Flanks {
            adjacent: Neighbourhood::from_cells(at_distance(1, direction, of)),
            across_edge: Neighbourhood::from_cells(across_edge(direction, of)),
            two_away: Neighbourhood::from_cells(at_distance(2, direction, of)),
        })
    })
});

/// Returns the cells that [`around`] depends on, for a face of a direction.
pub fn feature_cells(direction: Face) -> Neighbourhood {
    FEATURE_CELLS[direction as usize]
}

static FEATURE_CELLS: LazyLock<[Neighbourhood; 6]> = LazyLock::new(|| {
    Face::ALL.map(|direction| {
        let mut cells = in_reach(direction);
        let [of_cell, of_parent] = &FLANKS[direction as usize];
        for of in [of_cell, of_parent] {
            cells = cells.and(of.adjacent).and(of.across_edge);
        }
        cells = cells.and(of_parent.two_away);
        cells.block(direction.normal());
        cells
    })
});

/// Returns the directions perpendicular to `direction`.
pub(crate) fn aside(direction: Face) -> impl Iterator<Item = Face> {
    let others = Face::ALL.into_iter();
    others.filter(move |face| *face != direction && *face != direction.opposite())
}

/// Returns the cells at a distance from a cell, perpendicular to a direction.
fn at_distance(steps: i32, direction: Face, of: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    aside(direction).map(move |face| {
        let step = face.normal();
        std::array::from_fn(|axis| of[axis] + steps * step[axis])
    })
}

/// Returns the four diagonal cells perpendicular to a direction.
fn across_edge(direction: Face, of: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    let signs = [[1, 1], [1, -1], [-1, 1], [-1, -1]].into_iter();
    let along = direction.normal().map(i32::abs);
    signs.map(move |[u, v]| match along {
        [1, ..] => [of[0], of[1] + u, of[2] + v],
        [_, 1, _] => [of[0] + u, of[1], of[2] + v],
        _ => [of[0] + u, of[1] + v, of[2]],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_of_the_plate_has_ground_beside_its_parent() {
        let around = |cell,
                      direction,
                      is_full: &dyn Fn(Cell) -> bool,
                      open: &dyn Fn(Cell) -> Option<Face>| {
            around(cell, direction, Neighbourhood::new(cell, is_full), open)
        };
        let seen = around(Cell::new(0, 0, 1), Face::Up, &|_| false, &|_| None);
        assert!(seen.adjacent_parent && !seen.adjacent && seen.rivals == Rivals::default());
        let tower = |cell: Cell| (cell.x, cell.y) == (0, 0) && cell.z < 5;
        let seen = around(Cell::new(0, 0, 5), Face::Up, &tower, &|_| None);
        assert!(!seen.adjacent_parent && !seen.adjacent);
        let seen = around(Cell::new(1, 0, 1), Face::East, &tower, &|cell| {
            (cell == Cell::new(1, 1, 1)).then_some(Face::East)
        });
        assert!(seen.adjacent && seen.rivals.adjacent == 1);
    }

    #[test]
    fn counts_open_corners_and_rivals_across_edges() {
        for direction in Face::ALL {
            let cell = Cell::new(0, 0, 50);
            let at = |[x, y, z]: [i32; 3]| Cell::new(x, y, 50 + z);
            let corners: Vec<Cell> = across_edge(direction, [0; 3]).map(at).collect();
            let parent = direction.opposite().normal();
            let of_parent = across_edge(direction, parent)
                .map(at)
                .next()
                .expect("it has four");
            let flank = at_distance(1, direction, [0; 3])
                .map(at)
                .next()
                .expect("it has four");
            let seen = |full: &[Cell], open: &[Cell]| {
                let near = Neighbourhood::new(cell, |cell| full.contains(&cell));
                around(cell, direction, near, |cell| {
                    open.contains(&cell).then_some(direction)
                })
            };
            let corner = seen(&corners[..1], &corners[1..]);
            assert!(
                corner.corner && !corner.corner_parent && !corner.adjacent,
                "{direction:?}"
            );
            assert_eq!((corner.rivals.across, corner.rivals.adjacent), (3, 0));
            let both = seen(&[corners[0], flank, of_parent], &[]);
            assert!(!both.corner && both.adjacent && both.corner_parent && !both.adjacent_parent);
            assert_eq!(both.rivals, Rivals::default());
        }
    }

    #[test]
    fn counts_a_block_two_cells_from_the_parent() {
        for direction in Face::ALL {
            let cell = Cell::new(0, 0, 50);
            let at = |[x, y, z]: [i32; 3]| Cell::new(x, y, 50 + z);
            let parent = direction.opposite().normal();
            let seen = |full: &[Cell]| {
                let near =
                    Neighbourhood::new(cell, |near| near == at(parent) || full.contains(&near));
                around(cell, direction, near, |_| None).near_parent
            };
            let near: Vec<Cell> = at_distance(2, direction, parent).map(at).collect();
            assert!(!seen(&[]));
            assert!(near.iter().all(|near| seen(&[*near])), "{direction:?}");
            // Cells next to the open one are counted separately.
            let of_cell: Vec<Cell> = at_distance(1, direction, [0; 3]).map(at).collect();
            assert!(seen(&[near[0], of_cell[0]]) && !seen(&of_cell));
            assert!(!seen(
                &at_distance(2, direction, [0; 3])
                    .map(at)
                    .collect::<Vec<_>>()
            ));
            let nearer = at_distance(1, direction, parent).chain(across_edge(direction, parent));
            for nearer in nearer.map(at) {
                assert!(!seen(&[near[0], nearer]), "{direction:?}");
            }
        }
        let on_arm = |z: i32| {
            let cell = Cell::new(1, 0, z);
            let near = Neighbourhood::new(cell, |near| near == Cell::new(0, 0, z));
            around(cell, Face::East, near, |_| None).near_parent
        };
        assert_eq!([1, 2, 3].map(on_arm), [false, true, false]);
    }

    #[test]
    fn ignores_distant_cells() {
        for direction in Face::ALL {
            let all = crate::geometry::neighbourhood::all();
            let blocked = all.filter(|offset| !feature_cells(direction).is_blocked(*offset));
            let mut near = Neighbourhood::EMPTY;
            blocked.for_each(|offset| near.block(offset));
            assert_ne!(near, Neighbourhood::EMPTY);
            let seen = |near| around(Cell::new(0, 0, 50), direction, near, |_| None);
            assert_eq!(seen(near), seen(Neighbourhood::EMPTY), "{direction:?}");
        }
    }
}
