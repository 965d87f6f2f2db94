//! The 24 ways in which a cube can sit on the lattice.
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use stochc_ir::Face;

/// A rotation of the cube onto itself: takes a block's own faces to the structure's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Orientation {
    /// Where the block's own east points.
    east: Face,
    /// Where its own north points; up follows, because a block is not its mirror image.
    north: Face,
}

impl Orientation {
    /// The block's own faces are the structure's; how every block of the plate sits.
    pub const IDENTITY: Orientation = Orientation {
        east: Face::East,
        north: Face::North,
    };

    /// All 24, in a fixed order that begins with [`Orientation::IDENTITY`].
    pub fn all() -> impl Iterator<Item = Orientation> {
        Face::ALL.into_iter().flat_map(|east| {
            Face::ALL
                .into_iter()
                .filter(move |&north| north != east && north != east.opposite())
                .map(move |north| Orientation { east, north })
        })
    }

    /// The structure's face that the block's `own` face points to.
    pub fn to_structure(self, own: Face) -> Face {
        match own {
            Face::East => self.east,
            Face::West => self.east.opposite(),
            Face::North => self.north,
            Face::South => self.north.opposite(),
            Face::Up => cross(self.east, self.north),
            Face::Down => cross(self.north, self.east),
        }
    }

    /// The block's own face that points to the structure's face `structure`.
    pub fn to_own(self, structure: Face) -> Face {
        let towards = |own| self.to_structure(own) == structure;
        (Face::ALL.into_iter().find(|own| towards(*own))).expect("a rotation reaches every face")
    }

    /// This rotation after `first`.
    pub fn after(self, first: Orientation) -> Orientation {
        Orientation {
            east: self.to_structure(first.east),
            north: self.to_structure(first.north),
        }
    }

    /// The rotation that undoes this one.
    pub fn inverse(self) -> Orientation {
        Orientation {
            east: self.to_own(Face::East),
            north: self.to_own(Face::North),
        }
    }

    /// `turns` quarter turns about the outward normal of `axis`, counterclockwise seen from outside.
    pub fn turned(axis: Face, turns: u8) -> Orientation {
        let turn = |face: Face| {
            if face == axis || face == axis.opposite() {
                face
            } else {
                cross(axis, face)
            }
        };
        (0..turns % 4).fold(Orientation::IDENTITY, |done, _| Orientation {
            east: turn(done.east),
            north: turn(done.north),
        })
    }

    /// The orientation of a block that has docked.
    ///
    /// `parent` is how the parent sits, `parent_face` the face of its own that captured,
    /// `child_face` the face of the child's own that touches it. `turn` is a number of quarter
    /// turns about `parent_face`, counted from the first of [`Orientation::all`] (seen from the
    /// parent) that brings the two faces together.
    pub fn docked(
        parent: Orientation,
        parent_face: Face,
        child_face: Face,
        turn: u8,
    ) -> Orientation {
        let turns = &AS_SEEN[parent_face as usize][child_face as usize];
        parent.after(turns[usize::from(turn % 4)])
    }

    /// The child's face and the quarter turns with which a block that docks on `parent_face` of a block
    /// sitting in `parent` sits in this orientation: [`Orientation::docked`] backwards.
    pub fn as_docked(self, parent: Orientation, parent_face: Face) -> Option<(Face, u8)> {
        let child_face = self.to_own(parent.to_structure(parent_face).opposite());
        (0..4)
            .find(|&turn| Orientation::docked(parent, parent_face, child_face, turn) == self)
            .map(|turn| (child_face, turn))
    }
}

/// For a face of the parent's own, one of the child's own and a number of quarter turns, how the child sits
/// as the parent sees it.
static AS_SEEN: LazyLock<[[[Orientation; 4]; 6]; 6]> = LazyLock::new(|| {
    Face::ALL.map(|parent_face| {
        Face::ALL.map(|child_face| {
            let facing = Orientation::all()
                .find(|seen| seen.to_structure(child_face) == parent_face.opposite())
                .expect("four rotations bring two faces together");
            [0, 1, 2, 3].map(|turn| Orientation::turned(parent_face, turn).after(facing))
        })
    })
});

/// The face towards which the cross product of two perpendicular faces' normals points.
fn cross(a: Face, b: Face) -> Face {
    let (a, b) = (a as usize, b as usize);
    let (first, second) = (a / 2, b / 2);
    let against = usize::from((first + 1) % 3 != second);
    Face::ALL[2 * (3 - first - second) + (a + b + against) % 2]
}
