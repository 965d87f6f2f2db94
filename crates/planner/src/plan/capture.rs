//! Planned captures.
use serde::Serialize;
use stochc_ir::{Cell, Face};

use crate::timing::precedence::Why;

/// Planned capture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Capture {
    /// Cell of the block.
    pub cell: Cell,
    /// Direction of the capturing face. It points from the parent to this block.
    pub direction: Face,
    /// Mean waiting time \[ticks\].
    pub wait: f64,
    /// Cells that must be occupied before the face opens, each with the reason. Omits cells that
    /// are always occupied before one of the other cells.
    pub after: Vec<(Cell, Why)>,
    /// Whether no access path two cells wide was found.
    pub is_tight: bool,
    /// Whether the block belongs to a scaffold.
    pub is_temporary: bool,
    /// Fraction of runs with this capture on the critical path.
    pub decides: f32,
}

impl Capture {
    /// Returns a capture without predecessors and waiting time.
    pub(crate) fn at_once(cell: Cell, direction: Face) -> Capture {
        Capture {
            cell,
            direction,
            wait: 0.0,
            after: Vec::new(),
            is_tight: false,
            is_temporary: false,
            decides: 0.0,
        }
    }
}
