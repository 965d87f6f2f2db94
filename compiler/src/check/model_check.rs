//! Explores event tables in every order of events.
//!
//! The argument that the tables are right is in docs/concepts/protocol.md. This check does not rely
//! on it. Every `check` explores small programs. `verify` also explores large ones.
use std::fmt::Write as _;

use stochc_control::explore::{
    ExpectedEvent, Exploration, ExplorationBounds, Faults, ProgramGoals, Violation,
};
use stochc_ir::graph::{Dependency, EventGraph, EventId};
use stochc_ir::table::Tables;

use crate::check::checked::{Checked, Program};
use crate::diagnostic::{Code, Diagnostic};

/// Largest number of captures and releases of a small program. Every check explores small programs
/// in all orders of events.
const MAX_EVENTS: usize = 500;

/// Limits of the exploration in every check. They limit its time to about 60 ms. They count states
/// instead of time, so that results are the same on every machine.
const BOUNDS: ExplorationBounds = ExplorationBounds {
    states: 1_000,
    memory: 100_000_000,
    work: 100_000,
};

/// Advice for a violation. Every violation is a bug of stochc.
pub const MISTAKE: &str =
    "this is a bug in stochc, not in your program; please report it with the program";

/// Explores the event tables of small programs in a file without errors. If an order of events
/// fails, reports an error and removes the tables.
pub fn try_out(checked: &mut Checked) {
    if checked.has_errors() {
        return;
    }
    for program in &mut checked.programs {
        if let Some(fault) = fault(program) {
            checked.diagnostics.insert(0, fault);
            program.tables = None;
        }
    }
}

fn fault(program: &Program) -> Option<Diagnostic> {
    let is_small = program.plan.events.len() <= MAX_EVENTS;
    let tables = program.tables.as_ref().filter(|_| is_small)?;
    if tables.aggregate.is_some() {
        return None;
    }
    let expected = expected(&program.event_graph(), tables);
    let exploration = Exploration::new(tables, &expected, BOUNDS, Faults::default());
    let report = exploration.run();
    let found = report.violation()?;
    let Violation { what, trace, .. } = shortest(&exploration, found);
    let name = &tables.assembly;
    let title = format!("the compiled tables of `{name}` fail in one order of events");
    let mut help = format!("{MISTAKE}\n");
    for (number, line) in trace.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(help, "{:5}. {line}", number + 1);
    }
    let diagnostic = Diagnostic::new(Code::InternalError, title);
    let diagnostic = diagnostic.label(program.plan.location, what);
    Some(diagnostic.help(help.trim_end()))
}

/// Returns the goals that every run of the tables must reach. They are computed from the dependency
/// graph, independently of the tables, so that they can check the tables.
pub fn expected(graph: &EventGraph, tables: &Tables) -> ProgramGoals {
    let expected_event = (0..graph.events.len() as u32).map(EventId).map(|id| {
        let event = graph.event(id);
        let mut expected_event = ExpectedEvent {
            phase: event.phase,
            event: event.action.notification(),
            cell: event.cell,
            waits_for: Vec::new(),
            turn: (0, Vec::new()),
        };
        for edge in graph.waits_for(id) {
            let first = graph.event(edge.first).action.notification();
            match edge.why {
                Dependency::Face { needed, .. } => {
                    expected_event.turn.0 = usize::from(needed);
                    expected_event.turn.1.push(first);
                }
                _ => expected_event.waits_for.push(first),
            }
        }
        expected_event
    });
    ProgramGoals::from_events(tables, expected_event)
}

/// Returns the shortest sequence of events that violates the goals of the tables. Returns `found`
/// if the search reaches its limit.
pub fn shortest(exploration: &Exploration<'_>, found: &Violation) -> Violation {
    exploration.shortest().unwrap_or_else(|| found.clone())
}
