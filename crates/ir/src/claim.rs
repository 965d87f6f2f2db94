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
                let bound = rounded(*bound, 12);
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

/// Returns a time \[ticks\] as text with at most three decimals. Very short and very long times have
/// four digits.
fn ticks(ticks: f64) -> String {
    if ticks != 0.0 && !(1.0..1e15).contains(&ticks) {
        let rounded = rounded(ticks, 3);
        return if (1e-4..1.0).contains(&rounded) {
            format!("{rounded} ticks")
        } else {
            format!("{rounded:e} ticks")
        };
    }
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

/// Returns a number rounded to a number of decimals of its scientific notation. A percentage such as
/// 99.99 % is not exact.
fn rounded(value: f64, decimals: usize) -> f64 {
    let text = format!("{value:.decimals$e}");
    text.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_any_size_are_short_and_not_rounded_to_zero() {
        let cases = [
            (0.0, "0 ticks"),
            (49.505, "49.505 ticks"),
            (8000.0, "8000 ticks"),
            (0.25, "0.25 ticks"),
            (0.000_123_45, "0.0001234 ticks"),
            (1.5e-9, "1.5e-9 ticks"),
            (2e300, "2e300 ticks"),
        ];
        for (value, text) in cases {
            assert_eq!(ticks(value), text);
        }
        assert_eq!(rounded(99.99 * 0.01, 12).to_string(), "0.9999");
    }
}
