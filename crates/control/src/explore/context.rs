//! Constant data of an exploration.
use stochc_ir::table::Tables;

use super::expected::ProgramGoals;
use super::faults::{FaultChoice, Faults};
use super::{CanReach, Exploration};

/// Constant data of an exploration.
#[derive(Clone, Copy)]
pub(super) struct ExplorationContext<'a> {
    pub tables: &'a Tables,
    pub expected: &'a ProgramGoals,
    pub faults: Faults,
    pub reach: Option<&'a CanReach<'a>>,
    pub struck: &'a FaultChoice,
}

impl<'a> ExplorationContext<'a> {
    pub fn new(exploration: &Exploration<'a>, struck: &'a FaultChoice) -> ExplorationContext<'a> {
        ExplorationContext {
            tables: exploration.tables,
            expected: exploration.expected,
            faults: exploration.faults,
            reach: exploration.reach,
            struck,
        }
    }
}

impl ExplorationContext<'_> {
    /// Returns the number of the first stray block. Smaller numbers belong to blocks in roles.
    pub fn first_stray(&self) -> u32 {
        self.tables.roles.len() as u32
    }
}
