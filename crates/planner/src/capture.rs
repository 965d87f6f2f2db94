//! The captures of a plan.
use serde::Serialize;
use stochc_ir::{Cell, Face};

use crate::precedence::Why;

/// One capture of a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Capture {
    /// Where the block comes to.
    pub cell: Cell,
    /// From its parent: the face that captures it.
    pub way: Face,
    /// The mean ticks that the face is open.
    pub wait: f64,
    /// The cells that have to be full before the face opens, and why; what follows from others is left out.
    pub after: Vec<(Cell, Why)>,
    /// Whether no way in two cells wide was found.
    pub is_tight: bool,
    /// Whether the block belongs to a scaffold.
    pub is_temporary: bool,
    /// The part of runs in which it is on the chain of captures that decides when the run ends.
    pub decides: f32,
}

impl Capture {
    /// One that waits for nothing and takes no time.
    pub(crate) fn at_once(cell: Cell, way: Face) -> Capture {
        Capture {
            cell,
            way,
            wait: 0.0,
            after: Vec::new(),
            is_tight: false,
            is_temporary: false,
            decides: 0.0,
        }
    }
}
