//! What a plan has to know of the blocks.
use stochc_ir::scene::{BondKind, Scene};

/// What blocks can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardware {
    /// Faces that one block can open at the same time.
    pub faces: u8,
    /// Whether every face attracts all the time, so that none can be kept closed.
    pub attracts_always: bool,
    /// Free blocks.
    pub free: u32,
}

impl Hardware {
    /// That of a scene.
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
