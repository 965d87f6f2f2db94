//! What there is to be seen of a world at a tick.
use stochc_ir::Face;
use stochc_protocol::{BlockFace, Body, Orientation};

use super::Arena;

/// Where blocks are, and what pulls them. Faces are in the structure's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ArenaView {
    /// The [`pose`] of each free block, anchored or not, by number.
    pub poses: Vec<[f32; 7]>,
    /// The faces that are on and hold nothing.
    pub active: Vec<(Body, Face)>,
    /// The blocks in the reach of these faces.
    pub in_reach: Vec<(u32, Body, Face)>,
    /// The free blocks that are bonded to each other, by pairs.
    pub bonds: Vec<[u32; 2]>,
}

impl ArenaView {
    /// An arena as it is.
    pub(crate) fn of(arena: &impl Arena) -> ArenaView {
        let active = arena.active().into_iter();
        let in_reach = arena.in_reach().into_iter();
        let bonds = arena.free_bonds().into_iter();
        ArenaView {
            bonds: bonds.map(|bond| bond.bodies).collect(),
            poses: (0..arena.count()).map(|id| pose(arena, id)).collect(),
            active: active
                .filter_map(|(site, _)| in_structure(arena, site))
                .collect(),
            in_reach: in_reach
                .filter_map(|(site, id, _)| {
                    let (body, face) = in_structure(arena, site)?;
                    Some((id, body, face))
                })
                .collect(),
        }
    }
}

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
