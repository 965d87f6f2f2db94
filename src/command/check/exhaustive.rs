//! `stochc check --exhaustive`: event tables in every order of events.
use std::fmt::Write as _;

use stochc_compiler::Checked;
use stochc_control::explore::{
    ExceededBound, Exploration, ExplorationBounds, ExplorationReport, ExplorationVerdict, Faults,
};
use stochc_ir::table::Tables;
use stochc_ir::visible;
use stochc_runtime::counter_rng::schedules;

use super::super::terminal::warn;
use crate::exit::Exit;
use crate::model_check::{MISTAKE, expected, shortest};

/// Orders that are drawn by chance where there are too many.
const SCHEDULES: u64 = 1_000;

/// Steps looked at for them, at most: about a minute.
const SAMPLED: u64 = 200_000_000;

/// The key of that chance: the same orders each time.
const SEED: u64 = 0;

/// Explores the assemblies of a file without errors, each through at most so many states; what is to be said of them, and whether one
/// of them goes wrong. How it does is said on standard error.
pub fn explore(file: &str, checked: &Checked, states: u64) -> (String, Exit) {
    let (mut told, mut exit) = (String::new(), Exit::Success);
    let file = &*visible(file);
    for program in &checked.programs {
        let Some(tables) = &program.tables else {
            continue;
        };
        if tables.aggregate.is_some() {
            let name = &tables.assembly;
            let _ = writeln!(
                told,
                "{file}: aggregate {name}: nobody acts, so there are no orders to try"
            );
            continue;
        }
        let expected = expected(&program.event_graph(), tables);
        let bounds = ExplorationBounds {
            states,
            ..ExplorationBounds::default()
        };
        let mut exploration = Exploration::new(tables, &expected, bounds, Faults::default());
        let mut reports = vec![exploration.run()];
        if let ExplorationVerdict::Violated(found) = &mut reports[0].verdict {
            **found = shortest(&exploration, found);
        }
        if let ExplorationVerdict::Unfinished(_) = reports[0].verdict {
            exploration.bounds.work = SAMPLED;
            reports.push(exploration.sample(SCHEDULES, &mut schedules(SEED)));
        }
        let _ = write!(told, "{file}: assembly {}: ", tables.assembly);
        told.push_str(&describe(&reports, &bounds));
        let holds = reports[0].verdict == ExplorationVerdict::Holds;
        if holds && tables.bond.is_passive() {
            told.push_str(
                "  and a block that docks where nobody expects it changes nothing, at any moment\n",
            );
        }
        if let Some(wrong) = reports
            .iter()
            .find_map(|report| violation_message(file, tables, report))
        {
            warn(&wrong);
            exit = Exit::InvalidProgram;
        }
    }
    (told, exit)
}

fn describe(reports: &[ExplorationReport], bounds: &ExplorationBounds) -> String {
    let mut out = String::new();
    for report in reports {
        let visited = format!(
            "{} states, {} transitions",
            report.states, report.transitions
        );
        // Writing to a string cannot fail.
        let _ = match &report.verdict {
            ExplorationVerdict::Holds => writeln!(out, "holds in every order of events; {visited}"),
            ExplorationVerdict::Violated(violation) if report.schedules > 0 => writeln!(
                out,
                "goes wrong in order {} of those drawn by chance: {}",
                report.schedules + 1,
                violation.what
            ),
            ExplorationVerdict::Violated(violation) => {
                writeln!(out, "goes wrong: {}; {visited}", violation.what)
            }
            ExplorationVerdict::Sampled => writeln!(
                out,
                "  instead, nothing is wrong in {} orders drawn by chance; {} transitions",
                report.schedules, report.transitions
            ),
            ExplorationVerdict::Unfinished(bound) if out.is_empty() => {
                let reached = match bound {
                    ExceededBound::States => format!("{} states", bounds.states),
                    ExceededBound::Memory => format!("{} MB", bounds.memory / 1_000_000),
                    ExceededBound::Work => "the bound of work".to_owned(),
                };
                writeln!(
                    out,
                    "too many orders to explore them all: given up after {reached}, without having \
                     found anything wrong"
                )
            }
            ExplorationVerdict::Unfinished(_) => {
                writeln!(out, "  and too long to follow one to its end")
            }
        };
    }
    out
}

/// How a program goes wrong, as a message.
fn violation_message(file: &str, tables: &Tables, report: &ExplorationReport) -> Option<String> {
    let violation = report.violation()?;
    Some(format!(
        "error: the event tables of `{}` in {file} go wrong in some order of events\n{violation}help: {MISTAKE}\n",
        tables.assembly
    ))
}
