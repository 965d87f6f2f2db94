//! What an exploration finds out.
use stochc_ir::table::PhaseId;

/// What came of an exploration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExplorationReport {
    /// Different states visited.
    pub states: u64,
    /// Steps made from one state to another.
    pub transitions: u64,
    /// Choices of those whom faults strike, each of which was explored for itself; 1 without faults.
    pub choices: u64,
    /// Schedules followed from beginning to end, of an exploration by chance; 0: all of them.
    pub schedules: u64,
    /// Maximal orders of events, up to those that do not matter, that end before the program does.
    /// More than 0 only where [`Exploration::hangs_allowed`](super::Exploration) says so.
    pub hangs: u64,
    /// Steps and rules looked at, and blocks copied.
    pub work: u64,
    /// What it means.
    pub verdict: ExplorationVerdict,
}

/// What an exploration means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExplorationVerdict {
    /// Every property holds in every order of events.
    Holds,
    /// Every property holds in all schedules that were tried.
    Sampled,
    /// A property is violated.
    Violated(Box<Violation>),
    /// Nothing was found until a bound was reached.
    Unfinished(ExceededBound),
}

/// Why an exploration was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExceededBound {
    /// [`ExplorationBounds::states`](super::ExplorationBounds).
    States,
    /// [`ExplorationBounds::memory`](super::ExplorationBounds).
    Memory,
    /// [`ExplorationBounds::work`](super::ExplorationBounds).
    Work,
}

/// A property that does not hold, and how that comes about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Which.
    pub property: Property,
    /// In which phase.
    pub phase: PhaseId,
    /// What is wrong, in the program's names: `phase x ends before C is captured`.
    pub what: String,
    /// The events that lead there, one line each, in their order.
    pub trace: Vec<String>,
}

/// What has to hold in every order of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Property {
    /// Nothing happens before what it has to wait for.
    Order,
    /// No phase ends before all its captures and releases have happened.
    NoEarlyEnd,
    /// Every maximal order of events ends the program.
    NoHang,
    /// What stands at the end of each phase is what the program declares.
    Structure,
    /// Every report comes to the plate once, and before the phase ends.
    ReportsOnce,
    /// No block is let go that holds another one.
    NoneAdrift,
    /// No name is held by two blocks.
    OneHolder,
    /// No block magnetizes more faces than its hardware allows.
    Faces,
    /// A block that docks where nobody expects it is rejected, and changes nothing: at any moment and
    /// on any face, where every face always attracts.
    Unplanned,
}

impl Property {
    /// The property in a few words: `no phase ends early`.
    pub fn words(self) -> &'static str {
        match self {
            Property::Order => "nothing happens before what it waits for",
            Property::NoEarlyEnd => "no phase ends early",
            Property::NoHang => "no phase hangs",
            Property::Structure => "each phase ends with the declared structure",
            Property::ReportsOnce => "every report comes to the plate once",
            Property::NoneAdrift => "no block is let go that holds another one",
            Property::OneHolder => "no name is held by two blocks",
            Property::Unplanned => "no unplanned bond changes anything",
            Property::Faces => "no block magnetizes more faces than it has to spare",
        }
    }
}

impl ExplorationReport {
    /// Nothing explored yet.
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

    /// The violation that was found, if any.
    pub fn violation(&self) -> Option<&Violation> {
        match &self.verdict {
            ExplorationVerdict::Violated(violation) => Some(violation),
            _ => None,
        }
    }

    /// Whether every property holds in every order of events.
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
