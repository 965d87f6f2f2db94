//! Poses of blocks and faces in the structure's frame, for observers.
use stochc_control::{BlockFace, Body, Orientation};
use stochc_ir::Face;

use super::SpatialWorld;

/// Returns the position of a block's centre (x, y, z) \[block lengths\], then its rotation as a
/// quaternion (x, y, z, w).
pub fn pose(arena: &impl SpatialWorld, id: u32) -> [f32; 7] {
    let state = arena.state(id);
    let (p, q) = (state.position, state.orientation.coords);
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w].map(|number| number as f32)
}

/// Returns a face of an anchored block in the structure's frame, or `None` for a free block.
pub(crate) fn in_structure(
    arena: &impl SpatialWorld,
    block_face: BlockFace,
) -> Option<(Body, Face)> {
    let sits = match block_face.body {
        Body::Seed(_) => Orientation::IDENTITY,
        Body::Free(id) => arena.anchored(id)?,
    };
    Some((block_face.body, sits.to_structure(block_face.face)))
}
