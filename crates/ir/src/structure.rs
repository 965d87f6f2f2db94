//! What a program builds, phase by phase, to be drawn.
use crate::Cell;
use crate::plate::Plate;

/// The structures at the ends of all phases.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltStructure {
    /// The name of the program.
    pub program: String,
    /// What it grows from.
    pub plate: Plate,
    /// One for each phase, in their order.
    pub phases: Vec<BuiltPhase>,
}

/// What stands at the end of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltPhase {
    /// Its name.
    pub name: String,
    /// The blocks above the plate, sorted by cell.
    pub blocks: Vec<BuiltBlock>,
}

/// A block of a structure.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltBlock {
    /// Where it sits.
    pub cell: Cell,
    /// Its name.
    pub name: String,
    /// The number of the phase that captured it, from 0.
    pub since: usize,
}
