//! Structure of a program after each phase, for drawing.
use crate::Cell;
use crate::table::plate::Plate;

/// Structures at the ends of all phases.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltStructure {
    /// Name of the program.
    pub program: String,
    /// Plate.
    pub plate: Plate,
    /// Cells and names of the seeds above the plate, in a planar world. Other seeds are part of the
    /// plate.
    pub seeds: Vec<(Cell, String)>,
    /// Phases in order.
    pub phases: Vec<BuiltPhase>,
}

/// Structure at the end of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltPhase {
    /// Name of the phase.
    pub name: String,
    /// Blocks above the plate, sorted by cell.
    pub blocks: Vec<BuiltBlock>,
}

/// Block of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltBlock {
    /// Cell.
    pub cell: Cell,
    /// Name.
    pub name: String,
    /// Index of the phase that captured the block, from 0.
    pub since: usize,
}
