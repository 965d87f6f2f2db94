//! Limits of an expansion.
use stochc_grammar::Cancellation;

use crate::check::changes::ParameterChange;

/// Largest number of captures, releases and other results. A check of this size needs less than 300
/// MB.
const MAX_EVENTS: usize = 500_000;

/// Limits of an expanded program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of captures, releases, seeds, names in `after`, instances, phases and claims
    /// together.
    pub events: usize,
    /// Largest number of visited statements, including empty rounds of loops.
    pub steps: usize,
    /// Number of cells to search for access paths, in addition to 10 for every capture and release.
    pub search: u64,
    /// Command that has higher limits, for messages. `None` if there is none.
    pub further: Option<&'static str>,
}

impl Limits {
    /// Limits while a program is edited.
    pub const EDITOR: Limits = Limits {
        events: 200_000,
        steps: 10_000_000,
        search: 2_000_000,
        further: Some("stochc check"),
    };

    /// Returns the help for a program beyond the limits.
    pub(super) fn help(self, usual: &str) -> String {
        match self.further {
            Some(command) => format!("{usual}; `{command}` has a higher limit"),
            None => usual.to_owned(),
        }
    }
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            events: MAX_EVENTS,
            steps: 100_000_000,
            search: 2_000_000,
            further: None,
        }
    }
}

/// Limits, cancellation and parameters of an expansion.
#[derive(Clone, Copy, Debug)]
pub struct ExpansionSettings<'c> {
    pub limits: Limits,
    /// Values that replace the default values of parameters.
    pub parameters: &'c [ParameterChange],
    pub cancellation: Cancellation<'c>,
}

/// Inverse of a fraction of the event limit. Programs up to this fraction are expanded without
/// counting first. Larger programs are counted first, so that a program beyond the limit uses no
/// memory.
pub(super) const UNCOUNTED: usize = 5;

/// Largest depth of nested loops, instances and blocks of statements.
pub(crate) const MAX_NESTING: usize = 200;
