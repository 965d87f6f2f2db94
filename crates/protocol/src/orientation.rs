//! The 24 ways in which a cube can sit on the lattice.
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
    #[inline]
    pub const fn to_structure(self, own: Face) -> Face {
        TO_STRUCTURE[self.east as usize][self.north as usize][own as usize]
    }

    /// The block's own face that points to the structure's face `structure`.
    #[inline]
    pub fn to_own(self, structure: Face) -> Face {
        TO_OWN[self.east as usize][self.north as usize][structure as usize]
    }

    /// This rotation after `first`.
    #[inline]
    pub const fn after(self, first: Orientation) -> Orientation {
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
    pub const fn turned(axis: Face, turns: u8) -> Orientation {
        let mut done = Orientation::IDENTITY;
        let mut turn = 0;
        while turn < turns % 4 {
            done = Orientation {
                east: quarter_turn(axis, done.east),
                north: quarter_turn(axis, done.north),
            };
            turn += 1;
        }
        done
    }

    /// The orientation of a block that has docked.
    ///
    /// `parent` is how the parent sits, `parent_face` the face of its own that captured,
    /// `child_face` the face of the child's own that touches it. `turn` is a number of quarter
    /// turns about `parent_face`, counted from the first of [`Orientation::all`] (seen from the
    /// parent) that brings the two faces together.
    #[inline]
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
static AS_SEEN: [[[Orientation; 4]; 6]; 6] = {
    let mut seen = [[[Orientation::IDENTITY; 4]; 6]; 6];
    let mut i = 0;
    while i < 36 {
        let (parent_face, child_face) = (Face::ALL[i / 6], Face::ALL[i % 6]);
        let facing = facing(child_face, parent_face.opposite());
        let mut turn = 0;
        while turn < 4 {
            seen[i / 6][i % 6][turn] = Orientation::turned(parent_face, turn as u8).after(facing);
            turn += 1;
        }
        i += 1;
    }
    seen
};

/// The first of all orientations in which a block's `own` face points to the structure's face `structure`.
const fn facing(own: Face, structure: Face) -> Orientation {
    let mut i = 0;
    loop {
        let (east, north) = (Face::ALL[i / 6], Face::ALL[i % 6]);
        let seen = Orientation { east, north };
        if east as u8 / 2 != north as u8 / 2 && seen.to_structure(own) as u8 == structure as u8 {
            return seen;
        }
        i += 1;
    }
}

/// Of each orientation, by its east and north, the structure's faces that its own point to.
static TO_STRUCTURE: [[[Face; 6]; 6]; 6] = {
    let mut of = [[Face::ALL; 6]; 6];
    let mut i = 0;
    while i < 36 {
        let (east, north) = (Face::ALL[i / 6], Face::ALL[i % 6]);
        i += 1;
        if east as u8 / 2 == north as u8 / 2 {
            continue;
        }
        of[east as usize][north as usize] = [
            east,
            east.opposite(),
            north,
            north.opposite(),
            cross(east, north),
            cross(north, east),
        ];
    }
    of
};

/// Of each orientation, by its east and north, its own faces that point to the structure's.
static TO_OWN: [[[Face; 6]; 6]; 6] = {
    let mut of = [[Face::ALL; 6]; 6];
    let mut i = 0;
    while i < 36 * 6 {
        let (east, north, own) = (i / 36, i / 6 % 6, Face::ALL[i % 6]);
        let structure = TO_STRUCTURE[east][north][own as usize];
        of[east][north][structure as usize] = own;
        i += 1;
    }
    of
};

/// Where a face points after a quarter turn about the outward normal of `axis`.
const fn quarter_turn(axis: Face, face: Face) -> Face {
    if axis as u8 / 2 == face as u8 / 2 {
        face
    } else {
        cross(axis, face)
    }
}

/// The face towards which the cross product of two perpendicular faces' normals points.
const fn cross(a: Face, b: Face) -> Face {
    let (a, b) = (a as usize, b as usize);
    let (first, second) = (a / 2, b / 2);
    let against = ((first + 1) % 3 != second) as usize;
    Face::ALL[2 * (3 - first - second) + (a + b + against) % 2]
}
