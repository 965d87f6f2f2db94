//! Effects of the kind of bond on tables.
use crate::scene::{BondKind, Scene};

impl BondKind {
    /// Returns the kind of bond of a scene, or the default kind if the scene has no bond.
    pub fn from_scene(scene: &Scene) -> BondKind {
        let bond = scene.bond.as_ref();
        bond.map_or(BondKind::default(), |bond| bond.kind())
    }

    /// Returns the number of faces of a block that can capture at the same time. `faces` is the
    /// number that it can magnetize.
    ///
    /// There is no limit if every face always attracts, because faces are not switched.
    pub const fn faces(self, faces: u8) -> u8 {
        match self {
            BondKind::Attract | BondKind::Suction => faces,
            BondKind::Reject => 6,
        }
    }

    /// Returns whether a face can capture a block although it expects none.
    ///
    /// Such a capture is *unplanned*. The block that owns the face must undo it at once.
    pub const fn is_passive(self) -> bool {
        matches!(self, BondKind::Reject)
    }
}
