//! Claims about the runs of a program.
use crate::table::{PhaseId, RoleId, Tables};

/// Claim of a program about its runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Claim {
    /// Claim about the probability of an event.
    Probability {
        /// The event.
        event: ClaimedEvent,
        /// Time limit for the event \[ticks\], not rounded. `None` without a limit.
        within: Option<f64>,
        /// Relation of the probability to the bound.
        relation: Relation,
        /// Bound between 0 and 1.
        bound: f64,
    },
    /// Claim about the mean completion time.
    Mean {
        /// Relation of the mean to the bound.
        relation: Relation,
        /// Bound \[ticks\], not rounded.
        bound: f64,
    },
    /// Claim that the mean completion time is shorter than that of another program.
    Faster {
        /// Name of the other program.
        than: String,
        /// Smallest relative difference, from 0 to 1.
        by: f64,
    },
}

/// Event whose probability is claimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimedEvent {
    /// The program completes. Its time begins with the run.
    Completion,
    /// A phase ends. Its time begins with the phase.
    Phase(PhaseId),
    /// A block captures another block. The captured block gets the name, or had it before its
    /// release. The time begins with the run.
    Capture {
        /// Captured block.
        block: RoleId,
        /// Capturing block.
        by: RoleId,
    },
}

/// Relation of a value to a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// Relation `>=`.
    AtLeast,
    /// Relation `<=`.
    AtMost,
}

impl Relation {
    /// Returns the sign of the relation.
    pub const fn sign(self) -> &'static str {
        match self {
            Relation::AtLeast => ">=",
            Relation::AtMost => "<=",
        }
    }
}

impl Claim {
    /// Returns the claim as text, as in a program but with times in ticks. `tables` are those of
    /// its program.
    pub fn describe(&self, tables: &Tables) -> String {
        match self {
            Claim::Probability {
                event,
                within,
                relation,
                bound,
            } => {
                let event = event.describe(tables);
                let within = within.map_or_else(String::new, |it| format!(" within {}", ticks(it)));
                let sign = relation.sign();
                format!("{event}{within} with probability {sign} {bound}")
            }
            Claim::Mean { relation, bound } => {
                format!("mean completion {} {}", relation.sign(), ticks(*bound))
            }
            Claim::Faster { than, by } if *by == 0.0 => format!("faster than {than}"),
            Claim::Faster { than, by } => {
                let percent = (1e4 * by * 100.0).round() / 1e4;
                format!("faster than {than} by {percent} %")
            }
        }
    }
}

/// Returns a time \[ticks\] as text with at most three decimals.
fn ticks(ticks: f64) -> String {
    format!("{} ticks", (ticks * 1e3).round() / 1e3)
}

impl ClaimedEvent {
    fn describe(self, tables: &Tables) -> String {
        let role = |role: RoleId| &tables.roles[role.0 as usize].name;
        match self {
            ClaimedEvent::Completion => "complete".to_owned(),
            ClaimedEvent::Phase(phase) => {
                format!("phase {}", tables.phases[phase.0 as usize].name)
            }
            ClaimedEvent::Capture { block, by } => {
                format!("captured {} by {}", role(block), role(by))
            }
        }
    }
}
