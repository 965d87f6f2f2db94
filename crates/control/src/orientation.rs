//! The 24 orientations of a cube on the lattice.
use serde::{Deserialize, Serialize};
use stochc_ir::Face;

/// Orientation of a block. It maps the block's own faces to directions of the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Orientation {
    /// Direction of the block's own east face, in the structure's frame.
    east: Face,
    /// Direction of the block's own north face, in the structure's frame. Together with `east`, it
    /// determines the upper face, because reflections are excluded.
    north: Face,
}

impl Orientation {
    /// Orientation of every block of the plate. Own faces point in the structure's directions of
    /// the same name.
    pub const IDENTITY: Orientation = Orientation {
        east: Face::East,
        north: Face::North,
    };

    /// Returns all 24 orientations in a fixed order, [`Orientation::IDENTITY`] first.
    pub fn all() -> impl Iterator<Item = Orientation> {
        Face::ALL.into_iter().flat_map(|east| {
            Face::ALL
                .into_iter()
                .filter(move |&north| north != east && north != east.opposite())
                .map(move |north| Orientation { east, north })
        })
    }

    /// Returns the direction of the block's own face `own`, in the structure's frame.
    #[inline]
    pub const fn to_structure(self, own: Face) -> Face {
        TO_STRUCTURE[self.east as usize][self.north as usize][own as usize]
    }

    /// Returns the block's own face that points in the direction `structure`.
    #[inline]
    pub fn to_own(self, structure: Face) -> Face {
        TO_OWN[self.east as usize][self.north as usize][structure as usize]
    }

    /// Returns the rotation `first`, followed by this rotation.
    #[inline]
    pub const fn after(self, first: Orientation) -> Orientation {
        Orientation {
            east: self.to_structure(first.east),
            north: self.to_structure(first.north),
        }
    }

    /// Returns the inverse rotation.
    pub fn inverse(self) -> Orientation {
        Orientation {
            east: self.to_own(Face::East),
            north: self.to_own(Face::North),
        }
    }

    /// Returns the rotation by `turns` quarter turns about the outward normal of `axis`,
    /// counterclockwise seen from outside.
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

    /// Returns the orientation of a captured block.
    ///
    /// `parent` is the parent's orientation, `parent_face` its capturing face, and `child_face` the
    /// touching face of the child, each in its own frame. `turn` counts quarter turns about
    /// `parent_face`. Turn 0 is the first of [`Orientation::all`], in the parent's frame, that lets
    /// the two faces touch.
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

    /// Returns the arguments of [`Orientation::docked`] that give this orientation on
    /// `parent_face`: the child's face and the number of quarter turns. Returns `None` if no turn
    /// gives this orientation.
    pub fn as_docked(self, parent: Orientation, parent_face: Face) -> Option<(Face, u8)> {
        let child_face = self.to_own(parent.to_structure(parent_face).opposite());
        (0..4)
            .find(|&turn| Orientation::docked(parent, parent_face, child_face, turn) == self)
            .map(|turn| (child_face, turn))
    }
}

/// Orientation of the child in the parent's frame. The indices are parent face, child face and
/// quarter turns.
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

/// Returns the first orientation that turns the block's face `own` to the direction `structure`.
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

/// Direction of each own face in the structure's frame. The indices are the directions of east and
/// north, then the own face.
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

/// Own face that points in each direction of the structure. The indices are the directions of east
/// and north, then the structure's direction.
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

/// Returns the direction of a face after a quarter turn about the outward normal of `axis`.
const fn quarter_turn(axis: Face, face: Face) -> Face {
    if axis as u8 / 2 == face as u8 / 2 {
        face
    } else {
        cross(axis, face)
    }
}

/// Returns the direction of the cross product of the normals of two perpendicular faces.
const fn cross(a: Face, b: Face) -> Face {
    let (a, b) = (a as usize, b as usize);
    let (first, second) = (a / 2, b / 2);
    let against = ((first + 1) % 3 != second) as usize;
    Face::ALL[2 * (3 - first - second) + (a + b + against) % 2]
}
