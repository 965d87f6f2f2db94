//! Hardware properties that a plan depends on.
use stochc_ir::scene::{BondKind, Scene};

/// Capabilities of the blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Number of faces that one block can open at the same time.
    pub faces: u8,
    /// Whether every face always attracts, so that none can be kept closed.
    pub attracts_always: bool,
    /// Number of free blocks.
    pub free: u32,
}

impl Hardware {
    /// Returns the hardware of a scene.
    pub fn from_scene(scene: &Scene) -> Hardware {
        let attracts_always = BondKind::from_scene(scene).is_passive();
        Hardware {
            faces: if attracts_always {
                6
            } else {
                scene.block.faces
            },
            attracts_always,
            free: scene.free.count,
        }
    }
}
