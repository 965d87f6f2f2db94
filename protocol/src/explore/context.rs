//! What does not change while a program is explored.
use stochc_ir::table::Tables;

use super::expected::Expected;
use super::faults::{FaultChoice, Faults};
use super::{CanReach, Exploration};

/// What does not change while a program is explored.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub tables: &'a Tables,
    pub expected: &'a Expected,
    pub faults: Faults,
    pub reach: Option<&'a CanReach<'a>>,
    pub struck: &'a FaultChoice,
}

impl<'a> Context<'a> {
    pub fn new(exploration: &Exploration<'a>, struck: &'a FaultChoice) -> Context<'a> {
        Context {
            tables: exploration.tables,
            expected: exploration.expected,
            faults: exploration.faults,
            reach: exploration.reach,
            struck,
        }
    }
}

impl Context<'_> {
    /// From this number on, blocks have no role.
    pub fn first_stray(&self) -> u32 {
        self.tables.roles.len() as u32
    }
}
