//! Errors of planning, with suggested options.
use std::fmt::Display;

use stochc_planner::{TargetError, Unplanned};
use stochc_text::visible;

use super::options::{PlanOptions, PlanScope};
use crate::exit::{Exit, Failure};
use crate::host::Host;
use crate::operations::programs::verdict;

pub(super) fn refused(target: &str, reason: impl Display) -> Failure {
    Failure::error(Exit::InvalidProgram, format!("`{target}`: {reason}"))
}

/// Returns the failure for a target that cannot be built, with suggested options.
pub(super) fn impossible(options: &PlanOptions<'_>, error: &TargetError) -> Failure {
    let mut failure = refused(options.target, error);
    // Blocks of an existing structure cannot be left out of the plan.
    let stands =
        matches!(error, TargetError::Sealed(_)) && !matches!(options.extent, PlanScope::Whole);
    if let Some(help) = error.help().filter(|_| !stands) {
        let option = option_for(error, options.extent);
        failure.message += &format!("help: {}{option}\n", visible(&help));
    }
    failure
}

/// Returns the suggested options for an error in the target.
fn option_for(error: &TargetError, extent: PlanScope<'_>) -> &'static str {
    match (error, extent) {
        (TargetError::Loose(parts), PlanScope::Whole)
            if parts.iter().any(|it| it.rests_on_plate) =>
        {
            " (`--plate`, `--offset`); `--supports` adds such cells, `--drop-loose` leaves the parts out"
        }
        (TargetError::Loose(_), PlanScope::Whole) => {
            "; `--supports` adds such cells, `--drop-loose` leaves the parts out"
        }
        (TargetError::NoSeeds, _) => " (`--plate`)",
        (TargetError::TooFewBlocks { .. }, PlanScope::Whole | PlanScope::Rest(_)) => {
            " (`--free`, `--scene`)"
        }
        _ => "",
    }
}

/// Reason why there is no plan.
#[derive(Debug)]
pub struct NotPlanned {
    /// Message and exit status of the command.
    pub failure: Failure,
    /// Error in the target. `None` if something else failed.
    pub refused: Option<TargetError>,
}

impl From<Failure> for NotPlanned {
    fn from(failure: Failure) -> NotPlanned {
        NotPlanned {
            failure,
            refused: None,
        }
    }
}

impl From<NotPlanned> for Failure {
    fn from(not_planned: NotPlanned) -> Failure {
        not_planned.failure
    }
}

impl NotPlanned {
    pub(super) fn impossible(options: &PlanOptions<'_>, error: TargetError) -> NotPlanned {
        NotPlanned {
            failure: impossible(options, &error),
            refused: Some(error),
        }
    }

    pub(super) fn new(
        unplanned: Unplanned,
        options: &PlanOptions<'_>,
        host: &dyn Host,
    ) -> NotPlanned {
        match unplanned {
            Unplanned::Refused(TargetError::Cancelled) => NotPlanned::from(Failure {
                exit: Exit::Interrupted,
                message: "stopped before there was a plan\n".to_owned(),
            }),
            Unplanned::Refused(error) => NotPlanned::impossible(options, error),
            Unplanned::Wrong(checked) => {
                // A warning with level "deny" also prevents a program.
                NotPlanned::from(Failure {
                    exit: Exit::InvalidProgram.or_worse(verdict(&checked)),
                    message: host.draw(&checked),
                })
            }
        }
    }
}
