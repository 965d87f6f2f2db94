//! Poses of blocks and faces of the structure, as observers see them.
use stochc_ir::Face;
use stochc_protocol::{BlockFace, Body, Orientation};

use super::Arena;

/// The centre of a block \[side\], and its quaternion: x, y, z, x, y, z, w.
pub fn pose(arena: &impl Arena, id: u32) -> [f32; 7] {
    let state = arena.state(id);
    let (p, q) = (state.position, state.orientation.coords);
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w].map(|number| number as f32)
}

/// A face of an anchored block, in the structure's frame; `None`: the block is free.
pub(crate) fn in_structure(arena: &impl Arena, site: BlockFace) -> Option<(Body, Face)> {
    let sits = match site.body {
        Body::Seed(_) => Orientation::IDENTITY,
        Body::Free(id) => arena.anchored(id)?,
    };
    Some((site.body, sits.to_structure(site.face)))
}
