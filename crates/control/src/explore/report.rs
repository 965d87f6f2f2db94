//! Results of an exploration.
use stochc_ir::table::PhaseId;

/// Result of an exploration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExplorationReport {
    /// Number of distinct states visited.
    pub states: u64,
    /// Number of transitions made.
    pub transitions: u64,
    /// Number of fault choices explored. 1 without faults.
    pub choices: u64,
    /// Number of complete schedules, for random sampling. 0 for a full exploration.
    pub schedules: u64,
    /// Number of orders that end in a deadlock, except those that the reduction omits. Positive
    /// only with [`Exploration::hangs_allowed`](super::Exploration).
    pub hangs: u64,
    /// Number of steps, evaluated rules and copied blocks.
    pub work: u64,
    /// Verdict of the exploration.
    pub verdict: ExplorationVerdict,
}

/// Verdict of an exploration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExplorationVerdict {
    /// Every property holds in every order of events.
    Holds,
    /// Every property holds in all sampled schedules.
    Sampled,
    /// A property is violated.
    Violated(Box<Violation>),
    /// A limit was reached without finding a violation.
    Unfinished(ExceededBound),
}

/// Limit that ended an exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExceededBound {
    /// The limit [`ExplorationBounds::states`](super::ExplorationBounds).
    States,
    /// The limit [`ExplorationBounds::memory`](super::ExplorationBounds).
    Memory,
    /// The limit [`ExplorationBounds::work`](super::ExplorationBounds).
    Work,
}

/// Violated property, with a trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Violated property.
    pub property: Property,
    /// Phase of the violation.
    pub phase: PhaseId,
    /// Description in the program's names: `phase x ends before C is captured`.
    pub what: String,
    /// Events that lead to the violation, in order, one line each.
    pub trace: Vec<String>,
    /// Indices of the faults in the trace.
    pub faults: Vec<usize>,
}

/// Property that must hold in every order of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Property {
    /// Every event follows its predecessors.
    Order,
    /// No phase ends before all its captures and releases have happened.
    NoEarlyEnd,
    /// Every maximal order of events completes the program.
    NoHang,
    /// The structure at the end of each phase is as declared.
    Structure,
    /// A phase begins again with the structure of its start.
    Recovery,
    /// Every report reaches the plate once, before the phase ends.
    ReportsOnce,
    /// No block is released while it holds another one.
    NoneAdrift,
    /// No role is held by two blocks.
    OneHolder,
    /// No block magnetizes more faces than its hardware allows.
    Faces,
    /// Unplanned captures are rejected and change nothing, at any time and on any face that always
    /// attracts. The same holds for late captures in an aborted phase, for all faces.
    Unplanned,
}

impl Property {
    /// Returns a short description: `no phase ends early`.
    pub fn words(self) -> &'static str {
        match self {
            Property::Order => "every event follows its predecessors",
            Property::NoEarlyEnd => "no phase ends early",
            Property::NoHang => "no phase hangs",
            Property::Structure => "each phase ends with the declared structure",
            Property::Recovery => "a retry begins with the structure at the start of the phase",
            Property::ReportsOnce => "every report reaches the plate once",
            Property::NoneAdrift => "no block is released while it holds another",
            Property::OneHolder => "no name is held by two blocks",
            Property::Unplanned => "unplanned captures change nothing",
            Property::Faces => "no block magnetizes more faces than its hardware allows",
        }
    }
}

impl ExplorationReport {
    /// Returns a report of an exploration that has not begun.
    pub(super) fn empty(verdict: ExplorationVerdict) -> ExplorationReport {
        ExplorationReport {
            states: 0,
            transitions: 0,
            choices: 0,
            schedules: 0,
            hangs: 0,
            work: 0,
            verdict,
        }
    }

    /// Returns the violation, if there is one.
    pub fn violation(&self) -> Option<&Violation> {
        match &self.verdict {
            ExplorationVerdict::Violated(violation) => Some(violation),
            _ => None,
        }
    }

    /// Returns whether every property holds in every order of events.
    pub fn holds(&self) -> bool {
        self.verdict == ExplorationVerdict::Holds
    }
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.what)?;
        for (number, line) in self.trace.iter().enumerate() {
            writeln!(f, "{:5}. {line}", number + 1)?;
        }
        Ok(())
    }
}
