//! Open faces that compete for the same blocks.
use serde::{Deserialize, Serialize};
use stochc_ir::{Cell, Face, offsets_within};

/// Numbers of rivals of an open face: nearby open faces that compete for the same blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Rivals {
    /// Number of faces with the same direction whose open cells are next to this face's open cell.
    /// Includes only cells perpendicular to the normal.
    pub adjacent: u8,
    /// Number of faces with the same direction whose open cells are diagonal to this face's open
    /// cell. Includes only cells perpendicular to the normal.
    pub across: u8,
    /// Weighted number of all other faces nearby. A face counts 2 if its open cell shares a side or
    /// an edge with this open cell. It counts 1 if the cells share only a corner. Faces that point
    /// away count 0.
    pub around: u8,
}

/// Kind of rival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rivalry {
    /// Rival that [`Rivals::adjacent`] counts.
    Adjacent,
    /// Rival that [`Rivals::across`] counts.
    Across,
    /// Rival that [`Rivals::around`] counts twice: the open cells share a side or an edge.
    Around,
    /// Rival that [`Rivals::around`] counts once: the open cells share only a corner.
    AtCorner,
}

impl Rivals {
    /// Adds one rival of the kind `of` to the counts.
    pub fn add(&mut self, of: Rivalry) {
        let (number, one) = self.number(of);
        *number += one;
    }

    /// Removes one rival of the kind `of` from the counts.
    pub fn remove(&mut self, of: Rivalry) {
        let (number, one) = self.number(of);
        *number -= one;
    }

    fn number(&mut self, of: Rivalry) -> (&mut u8, u8) {
        match of {
            Rivalry::Adjacent => (&mut self.adjacent, 1),
            Rivalry::Across => (&mut self.across, 1),
            Rivalry::Around => (&mut self.around, 2),
            Rivalry::AtCorner => (&mut self.around, 1),
        }
    }
}

/// Returns the kind of competition between two faces. Each face is given by the cell that it is
/// open to, and its direction. Returns `None` if they do not compete.
pub fn rivalry((cell, direction): (Cell, Face), other: (Cell, Face)) -> Option<Rivalry> {
    let difference = |to: i32, from: i32| to.checked_sub(from).filter(|it| it.abs() <= 1);
    let offset = [
        difference(other.0.x, cell.x)?,
        difference(other.0.y, cell.y)?,
        difference(other.0.z, cell.z)?,
    ];
    let along = |direction: Face| match direction as usize % 2 {
        0 => offset[direction as usize / 2],
        _ => -offset[direction as usize / 2],
    };
    let apart: i32 = offset.iter().map(|part| part.abs()).sum();
    match apart {
        0 => None,
        1 if other.1 == direction && along(direction) == 0 => Some(Rivalry::Adjacent),
        2 if other.1 == direction && along(direction) == 0 => Some(Rivalry::Across),
        _ if along(other.1) > 0 => None,
        3 => Some(Rivalry::AtCorner),
        _ => Some(Rivalry::Around),
    }
}

/// Returns the rivals of a face open to `cell` in a direction. `open` returns the direction of the face
/// open to a cell.
pub fn rivals(cell: Cell, direction: Face, open: impl Fn(Cell) -> Option<Face>) -> Rivals {
    let mut rivals = Rivals::default();
    for offset in touching() {
        let Some(near) = cell.offset(offset) else {
            continue;
        };
        let rivalry = open(near).and_then(|other| rivalry((cell, direction), (near, other)));
        if let Some(rivalry) = rivalry {
            rivals.add(rivalry);
        }
    }
    rivals
}

/// Returns the offsets of all cells that touch a cell.
fn touching() -> impl Iterator<Item = [i32; 3]> {
    offsets_within(1).filter(|offset| *offset != [0; 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Cell = Cell::new(0, 0, 50);

    fn found(direction: Face, open: &[([i32; 3], Face)]) -> Rivals {
        let open: Vec<_> = (open.iter())
            .filter_map(|(offset, direction)| Some((CELL.offset(*offset)?, *direction)))
            .collect();
        rivals(CELL, direction, |cell| {
            let mut faces = open.iter();
            faces
                .find(|(at, _)| *at == cell)
                .map(|(_, direction)| *direction)
        })
    }

    #[test]
    fn faces_of_the_same_direction_are_classified() {
        let up = |offset: [i32; 3]| found(Face::Up, &[(offset, Face::Up)]);
        let counts = |rivals: Rivals| [rivals.adjacent, rivals.across, rivals.around];
        assert_eq!(counts(up([1, 0, 0])), [1, 0, 0]);
        assert_eq!(counts(up([1, -1, 0])), [0, 1, 0]);
        assert_eq!(counts(up([0, 1, -1])), [0, 0, 2]);
        assert_eq!(counts(up([1, 1, -1])), [0, 0, 1]);
        // One step ahead, with its parent next to the open cell.
        assert_eq!(counts(up([0, 1, 1])), [0; 3]);
        assert_eq!(counts(up([0, 2, 0])), [0; 3]);
    }

    #[test]
    fn faces_of_other_directions_are_classified() {
        let around = |offset, other| found(Face::Up, &[(offset, other)]).around;
        assert_eq!(around([1, 0, 0], Face::North), 2);
        assert_eq!(around([1, 0, 0], Face::West), 2);
        assert_eq!(around([1, 0, 0], Face::Down), 2);
        assert_eq!(around([1, 0, 0], Face::East), 0);
        assert_eq!(around([1, 1, 0], Face::North), 0);
        assert_eq!(around([1, 1, 0], Face::South), 2);
        assert_eq!(around([1, 0, -1], Face::North), 2);
        assert_eq!(around([1, 0, -1], Face::East), 0);
        assert_eq!(around([0, 0, 1], Face::Down), 2);
        assert_eq!(around([1, 1, -1], Face::South), 1);
        assert_eq!(around([1, -1, 1], Face::South), 0);
        assert_eq!(around([2, 0, 0], Face::West), 0);
    }

    #[test]
    fn a_rotated_pattern_has_the_same_rivals() {
        for direction in Face::ALL {
            let [x, y, z] = direction.normal().map(i32::abs);
            let adjacent = [y, z, x];
            let other = Face::ALL.into_iter().find(|face| face.normal() == adjacent);
            let other = other.expect("there is one");
            let found = found(
                direction,
                &[
                    (adjacent, direction),
                    (adjacent.map(|part| -part), other),
                    ([0; 3], direction),
                ],
            );
            let expected = Rivals {
                adjacent: 1,
                across: 0,
                around: 2,
            };
            assert_eq!(found, expected, "{direction:?}");
        }
    }

    #[test]
    fn overflowing_cells_are_not_near() {
        let [low, high] = [i32::MIN, i32::MAX].map(|x| (Cell::new(x, 0, 1), Face::Up));
        assert_eq!(rivalry(low, high), None);
        assert_eq!(rivals(high.0, Face::Up, |_| Some(Face::Up)).adjacent, 3);
    }
}
