//! Structures at the ends of phases.
use stochc_ir::Cell;
use stochc_ir::table::RoleId;

use crate::expanded::{EventId, EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

/// A block of the structure, above the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedBlock {
    /// Cell of the block.
    pub cell: Cell,
    /// Name of the block.
    pub role: RoleId,
    /// Capture that attached the block.
    pub capture: EventId,
    /// Phase of the block's capture.
    pub since: u32,
}

/// Returns the blocks above the plate at the end of each phase, sorted by cell.
pub fn placed_blocks<'a>(
    plan: &'a ExpandedProgram,
    layout: &'a Layout,
) -> impl Iterator<Item = Vec<PlacedBlock>> + use<'a> {
    // Phase of the capture of each attached block.
    let mut standing: Vec<Option<u32>> = vec![None; plan.events.len()];
    (0..).zip(&plan.phases).map(move |(since, phase)| {
        let valid = || plan.events_of(phase).filter(|&id| plan.event(id).valid);
        for id in valid().map(|id| id.0 as usize) {
            if let (EventKind::Capture { .. }, Some(_)) = (plan.events[id].kind, layout.cells[id]) {
                standing[id] = Some(since);
            }
        }
        for id in valid().filter(|&id| plan.event(id).kind == EventKind::Release) {
            if let Some(on) = layout.parents[id.0 as usize] {
                standing[on.capture.0 as usize] = None;
            }
        }
        let captures = standing.iter().zip(&plan.events).zip(&layout.cells);
        let blocks = (0..)
            .zip(captures)
            .filter_map(|(number, ((since, event), cell))| {
                Some(PlacedBlock {
                    cell: (*cell)?,
                    role: event.role,
                    capture: EventId(number),
                    since: (*since)?,
                })
            });
        let mut blocks: Vec<PlacedBlock> = blocks.collect();
        blocks.sort_by_key(|block| block.cell);
        blocks
    })
}
