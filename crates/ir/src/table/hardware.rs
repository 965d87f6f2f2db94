//! What a kind of hardware makes of a table: one program, three ways to capture and to let go.
use crate::scene::{BondKind, Scene};

impl BondKind {
    /// That of a scene; the default one, if nothing bonds there.
    pub fn from_scene(scene: &Scene) -> BondKind {
        let bond = scene.bond.as_ref();
        bond.map_or(BondKind::default(), |bond| bond.kind())
    }

    /// Faces with which a block captures at the same time, at most, of one that magnetizes `faces`.
    ///
    /// Where every face always attracts nothing has to be switched on, so nothing sets a limit.
    pub const fn faces(self, faces: u8) -> u8 {
        match self {
            BondKind::Attract | BondKind::Suction => faces,
            BondKind::Reject => 6,
        }
    }

    /// Whether blocks also dock on faces that nobody has made capture: an *unplanned bond*, which
    /// its owner has to undo at once.
    pub const fn is_passive(self) -> bool {
        matches!(self, BondKind::Reject)
    }
}
