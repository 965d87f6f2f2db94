//! Second phase of a plan with scaffolds.
use rustc_hash::{FxHashMap, FxHashSet};
use serde::Serialize;
use stochc_ir::{Cell, Face};

use super::{MastSegment, Scaffolding};
use crate::plan::capture::Capture;

/// Second phase of a plan with scaffolds.
#[derive(Clone, Debug, Serialize)]
pub struct Dismantling {
    /// Hand-overs. Each comes after the hand-over of its new parent.
    pub hand_overs: Vec<HandOver>,
    /// Masts.
    pub masts: Vec<Mast>,
    /// Whether masts remain.
    pub are_permanent: bool,
    /// Later captures, in opening order for mean waiting times.
    pub captures: Vec<Capture>,
}

/// Block that is released and captured again in place by an adjacent block.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HandOver {
    /// Cell of the block.
    pub cell: Cell,
    /// Direction from the new parent.
    pub direction: Face,
    /// Cell whose capture in the same phase must come before this hand-over. `None` if there is
    /// none.
    pub after: Option<Cell>,
}

/// Column of temporary blocks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mast {
    /// Position of the mast on the plate, as (x, y).
    pub foot: (i32, i32),
    /// Number of blocks.
    pub height: i32,
    /// Cells that must be handed over before the mast is released.
    pub after: Vec<Cell>,
}

impl Dismantling {
    /// Returns the second phase for scaffolds and the later captures.
    pub fn new(
        scaffolding: &Scaffolding,
        captures: Vec<Capture>,
        are_permanent: bool,
    ) -> Dismantling {
        // Captures of this phase, and the last hand-over to each block.
        let mut new: FxHashSet<Cell> = captures.iter().map(|capture| capture.cell).collect();
        let mut last: FxHashMap<Cell, Cell> = FxHashMap::default();
        let mut hand_overs = Vec::new();
        for segment in in_order(scaffolding) {
            for (cell, direction) in segment.handed_over() {
                let holder = cell.across(direction.opposite());
                let holder = holder.expect("a cell of the target");
                let before = last.insert(holder, cell);
                hand_overs.push(HandOver {
                    cell,
                    direction,
                    after: before.or_else(|| new.contains(&holder).then_some(holder)),
                });
                new.insert(cell);
            }
        }
        let masts = scaffolding.masts().into_iter().map(|(foot, height)| {
            let segments = scaffolding.segments.iter();
            let held = segments.filter(|segment| segment.foot == foot);
            Mast {
                foot,
                height,
                after: held.map(|segment| segment.cells[0]).collect(),
            }
        });
        Dismantling {
            hand_overs,
            masts: masts.collect(),
            are_permanent,
            captures,
        }
    }
}

/// Returns the segments in hand-over order. A segment that joins another segment comes after it.
fn in_order(scaffolding: &Scaffolding) -> Vec<&MastSegment> {
    let mut left: Vec<&MastSegment> = scaffolding.segments.iter().collect();
    let mut order = Vec::new();
    while !left.is_empty() {
        let is_last =
            |segment: &&MastSegment| !left.iter().any(|other| other.cells.contains(&segment.join));
        let (next, rest): (Vec<&MastSegment>, Vec<&MastSegment>) =
            left.iter().copied().partition(is_last);
        // A cycle of segments would have no support.
        assert!(!next.is_empty(), "every segment joins the target");
        order.extend(next);
        left = rest;
    }
    order
}
