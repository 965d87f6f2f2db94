//! `stochc verify --faults`: whether a program completes in every order with dead blocks.
use std::fmt::Write as _;

use serde_json::{Value, json};
use stochc_control::explore::{
    Exploration, ExplorationReport, ExplorationVerdict, Faults, Property, Violation,
};
use stochc_ir::table::{Action, Rule, Tables};
use stochc_text::{counted, visible};

use super::verify::reports;
use stochc_compiler::model_check::MISTAKE;

/// Result of the exploration with dead blocks.
#[derive(Debug)]
pub(super) struct Survival {
    /// Largest number of dockings of dead blocks.
    dead: u8,
    reports: Vec<ExplorationReport>,
}

impl Survival {
    /// Explores all orders with at most `dead` dockings of blocks that never answer.
    pub fn explore(exploration: &Exploration<'_>, dead: u8) -> Survival {
        let faults = Faults {
            silent: dead,
            ..exploration.faults
        };
        let exploration = Exploration {
            faults,
            ..*exploration
        };
        Survival {
            dead,
            reports: reports(&exploration),
        }
    }

    fn violation(&self) -> Option<&Violation> {
        (self.reports.iter()).find_map(ExplorationReport::violation)
    }

    fn dockings(&self) -> String {
        match self.dead {
            1 => "1 docking of a dead block".to_owned(),
            dead => format!("{dead} dockings of dead blocks"),
        }
    }

    /// Returns whether all orders were explored, at least up to a fault.
    pub fn is_complete(&self) -> bool {
        self.orders().is_none()
    }

    /// Returns the number of random orders. Returns `None` if all orders were explored.
    fn orders(&self) -> Option<u64> {
        self.reports.get(1).map(|report| report.schedules)
    }

    pub fn describe(&self) -> String {
        let dockings = self.dockings();
        let first = &self.reports[0];
        let visited = format!("{} states, {} transitions", first.states, first.transitions);
        match (self.violation(), self.orders()) {
            (Some(violation), _) => {
                format!("  Does not survive {dockings}: {}.\n", violation.what)
            }
            (None, None) => format!("  Survives {dockings} in every order: {visited}.\n"),
            (None, Some(orders)) => format!("  Survives {dockings} in {orders} random orders.\n"),
        }
    }

    /// Returns the result as `{ dead, outcome, states, transitions, orders, fault, trace }`.
    pub fn json(&self) -> Value {
        let violation = self.violation();
        let outcome = match (violation, &self.reports[0].verdict) {
            (Some(_), _) => "not_survived",
            (None, ExplorationVerdict::Holds) => "every_order",
            (None, _) => "random_orders",
        };
        json!({
            "dead": self.dead,
            "outcome": outcome,
            "states": self.reports[0].states,
            "transitions": self.reports[0].transitions,
            "orders": self.orders(),
            "fault": violation.map(|violation| &violation.what),
            "trace": violation.map(|violation| &violation.trace),
        })
    }

    /// Returns the message about a program that does not survive, with the sequence of events that
    /// leads to the fault. Returns `None` if the program survives.
    pub fn message(&self, file: &str, tables: &Tables) -> Option<String> {
        let violation = self.violation()?;
        let help = match violation.property {
            Property::NoHang => self.help(violation, tables),
            _ => MISTAKE.to_owned(),
        };
        let (name, dockings) = (&tables.assembly, self.dockings());
        let (what, steps) = (&violation.what, steps(violation));
        Some(format!(
            "error: `{name}` in {file} does not survive {dockings}\n{what}\n{steps}help: {help}\n"
        ))
    }

    fn help(&self, violation: &Violation, tables: &Tables) -> String {
        let phase = &tables.phases[violation.phase.0 as usize];
        let (name, dead) = (visible(&phase.name), self.dead);
        if phase.recovery.is_some() {
            return format!("write `retry {dead}` in phase `{name}`");
        }
        let is_release = |rule: Rule<'_>| matches!(rule.then, Action::SwitchOff { .. });
        let mut duties = tables.duties().filter(|duty| duty.phase == violation.phase);
        if duties.any(|duty| duty.rules().any(is_release)) {
            return format!(
                "write the releases of phase `{name}` in a phase of their own. The captures can then be retried"
            );
        }
        let timeout = match phase.timeout {
            Some(_) => "",
            None => "a timeout and ",
        };
        format!("add {timeout}`on timeout {{ release {name}  retry {dead} }}` to phase `{name}`")
    }
}

/// Returns the faults and the last steps of a trace, one line each.
fn steps(violation: &Violation) -> String {
    /// Number of last steps.
    const LAST: usize = 20;
    let count = violation.trace.len();
    let (mut out, mut hidden) = (String::new(), 0);
    for (at, step) in violation.trace.iter().enumerate() {
        if at + LAST < count && !violation.faults.contains(&at) {
            hidden += 1;
            continue;
        }
        // Writing to a string cannot fail.
        if hidden > 0 {
            let hidden = counted(std::mem::take(&mut hidden), "step");
            let _ = writeln!(out, "       ... {hidden} not shown; `--json` lists all");
        }
        let _ = writeln!(out, "{:5}. {step}", at + 1);
    }
    out
}
