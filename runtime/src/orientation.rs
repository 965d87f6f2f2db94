//! The 24 ways in which a cube can sit on the lattice.
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use stochc_ir::Face;

/// A rotation of the cube onto itself: takes a block's own faces to the structure's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
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
        self.inverse().to_structure(structure)
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
        let source = |target: Face| {
            Face::ALL
                .into_iter()
                .find(|&own| self.to_structure(own) == target)
                .expect("a rotation reaches every face")
        };
        Orientation {
            east: source(Face::East),
            north: source(Face::North),
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
        let facing = Orientation::all()
            .find(|seen| seen.to_structure(child_face) == parent_face.opposite())
            .expect("four rotations bring two faces together");
        parent.after(Orientation::turned(parent_face, turn).after(facing))
    }

    /// The child's face and the quarter turns with which a block that docks on `parent_face` of a block
    /// sitting in `parent` sits in this orientation: [`Orientation::docked`] backwards.
    pub fn as_docked(self, parent: Orientation, parent_face: Face) -> Option<(Face, u8)> {
        let child_face = self.to_own(parent.to_structure(parent_face).opposite());
        (0..4)
            .find(|&turn| Orientation::docked(parent, parent_face, child_face, turn) == self)
            .map(|turn| (child_face, turn))
    }

    /// As a matrix whose columns are the structure's directions of the block's own x, y and z.
    pub fn matrix(self) -> Matrix3<f64> {
        let column = |own| nalgebra::Vector3::from(self.to_structure(own).normal()).cast::<f64>();
        Matrix3::from_columns(&[column(Face::East), column(Face::North), column(Face::Up)])
    }

    /// As a quaternion: own coordinates to the structure's.
    pub fn quaternion(self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.matrix()))
    }
}

/// The face towards which the cross product of two perpendicular faces' normals points.
fn cross(a: Face, b: Face) -> Face {
    let ([a0, a1, a2], [b0, b1, b2]) = (a.normal(), b.normal());
    let normal = [a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0];
    Face::ALL
        .into_iter()
        .find(|face| face.normal() == normal)
        .expect("perpendicular faces span a third")
}
