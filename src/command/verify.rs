//! `stochc verify`: executes event tables in every order of events.
use std::fmt::Write as _;

use clap::Args;
use serde_json::{Value, json};
use stochc_compiler::Checked;
use stochc_control::explore::{
    ExceededBound, Exploration, ExplorationBounds, ExplorationReport, ExplorationVerdict, Faults,
};
use stochc_files::programs::programs;
use stochc_ir::table::Tables;
use stochc_runtime::counter_rng::schedules;
use stochc_text::{counted, visible};

use super::run_options::JsonOption;
use super::source_options::SourceOptions;
use super::survival::Survival;
use super::terminal::{exit_of, has_colour, message_width, print, print_folded, warn, warn_drawn};
use crate::diagnostics::{CheckDocument, drawn};
use crate::exit::{Exit, Failure};
use crate::operations::programs::{is_readable, nothing_to_run, verdict};
use crate::operations::summary::status_lines;
use crate::source_settings::UnusedValues;
use stochc_compiler::model_check::{MISTAKE, expected, shortest};

/// Number of sampled orders if a program has too many orders for all of them.
const SCHEDULES: u64 = 1_000;

/// Limit on the total steps of the sampled orders. This number of steps takes about a minute.
const SAMPLED: u64 = 200_000_000;

const SEED: u64 = 0;

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Programs to verify, or folders that contain programs (`*.sa`)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,
    /// Explore at most this many states of each program. A program with more states is executed in random orders
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    states: u64,
    /// Also explore all orders with at most this many dockings of dead blocks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    faults: Option<u8>,
    #[command(flatten)]
    output: JsonOption,
    #[command(flatten)]
    source: SourceOptions,
}

/// Number of programs with each result of the verification.
#[derive(Debug, Default)]
struct Verified {
    completely: usize,
    in_random_orders: usize,
    wrong: usize,
    /// Number of programs that do not survive the dead blocks.
    failed: usize,
}

/// Checks programs, then executes their event tables in every order of events.
pub fn run(options: &VerifyArguments) -> Result<Exit, Failure> {
    let mut exit = Exit::Success;
    let mut verified = Verified::default();
    let mut document = CheckDocument::default();
    let source = options.source.settings();
    let mut unused = UnusedValues::new(&source);
    for file in programs(&options.files) {
        let done = file.map_err(Failure::usage);
        let done =
            done.and_then(|file| verify(&file, options, &mut unused, &mut verified, &mut document));
        exit = exit.or_worse(exit_of(done));
    }
    if exit == Exit::Success {
        exit = exit_of(unused.check().map(|()| Exit::Success));
    }
    if options.output.json {
        print(&document.text())?;
    } else {
        print(&verified.summary())?;
    }
    Ok(exit)
}

fn verify(
    file: &str,
    options: &VerifyArguments,
    unused: &mut UnusedValues<'_>,
    verified: &mut Verified,
    document: &mut CheckDocument,
) -> Result<Exit, Failure> {
    is_readable(file)?;
    let checked = crate::check_source(file, unused.settings());
    let is_json = options.output.json;
    if !is_json {
        warn_drawn(&drawn(&checked, has_colour(), message_width()));
    }
    if checked.has_errors() {
        document.add(file, &checked, "", |_| None);
        return Ok(verdict(&checked));
    }
    if checked.programs.is_empty() {
        return Err(nothing_to_run(file, &checked));
    }
    unused.remove_used_by(&checked.programs);
    let mut explored = Vec::new();
    let exit = explore(file, &checked, options, verified, &mut explored)?;
    document.add(file, &checked, "exploration", |program| {
        let mut known = explored.iter();
        known.find_map(|(name, value): &(&str, Value)| {
            (*name == program.plan.name).then(|| value.clone())
        })
    });
    Ok(exit)
}

impl Verified {
    fn summary(&self) -> String {
        let mut parts = vec![format!(
            "every order of events explored: {}",
            self.completely
        )];
        if self.in_random_orders > 0 {
            parts.push(format!(
                "{SCHEDULES} random orders: {}",
                self.in_random_orders
            ));
        }
        if self.wrong > 0 {
            parts.push(format!("wrong: {}", self.wrong));
        }
        if self.failed > 0 {
            parts.push(format!("not surviving dead blocks: {}", self.failed));
        }
        let all = self.completely + self.in_random_orders + self.wrong;
        format!(
            "{} verified; {}\n",
            counted(all, "program"),
            parts.join(", ")
        )
    }
}

/// Executes the programs of an error-free file in every order of events. Adds the name and the
/// result of each program to `explored`.
fn explore<'a>(
    file: &str,
    checked: &'a Checked,
    options: &VerifyArguments,
    verified: &mut Verified,
    explored: &mut Vec<(&'a str, Value)>,
) -> Result<Exit, Failure> {
    let say = |text: &str| {
        if options.output.json {
            Ok(())
        } else {
            print_folded(text)
        }
    };
    let mut exit = Exit::Success;
    let file = &*visible(file);
    for (number, program) in checked.programs.iter().enumerate() {
        let Some(tables) = &program.tables else {
            continue;
        };
        say(&status_lines(checked, number))?;
        if tables.aggregate.is_some() {
            continue;
        }
        let expected = expected(&program.event_graph(), tables);
        let bounds = ExplorationBounds {
            states: options.states,
            ..ExplorationBounds::default()
        };
        let exploration = Exploration::new(tables, &expected, bounds, Faults::default());
        let reports = reports(&exploration);
        say(&describe(&reports, &bounds))?;
        let holds = reports[0].verdict == ExplorationVerdict::Holds;
        if holds && tables.bond.is_passive() {
            say("  Stray blocks that dock at any moment change nothing.\n")?;
        }
        let mut document = exploration_json(&reports);
        let violation = reports
            .iter()
            .find_map(|report| violation_message(file, tables, report));
        let is_right = violation.is_none();
        let mut is_complete = holds;
        if let Some(dead) = options.faults.filter(|_| is_right) {
            let survival = Survival::explore(&exploration, dead);
            is_complete &= survival.is_complete();
            say(&survival.describe())?;
            document["survival"] = survival.json();
            if let Some(message) = survival.message(file, tables) {
                warn(&message);
                exit = exit.or_worse(Exit::UnsuccessfulRun);
                verified.failed += 1;
            }
        }
        if let Some(wrong) = violation {
            warn(&wrong);
            exit = Exit::InvalidProgram;
            verified.wrong += 1;
        } else if is_complete {
            verified.completely += 1;
        } else {
            verified.in_random_orders += 1;
        }
        explored.push((&program.plan.name, document));
    }
    Ok(exit)
}

/// Explores all orders of events. If there are too many, explores random orders too.
pub(super) fn reports(exploration: &Exploration<'_>) -> Vec<ExplorationReport> {
    let mut reports = vec![exploration.run()];
    if let ExplorationVerdict::Violated(found) = &mut reports[0].verdict {
        **found = shortest(exploration, found);
    }
    if let ExplorationVerdict::Unfinished(_) = reports[0].verdict {
        let mut exploration = *exploration;
        exploration.bounds.work = SAMPLED;
        reports.push(exploration.sample(SCHEDULES, &mut schedules(SEED)));
    }
    reports
}

/// Returns the result of an exploration as `{ outcome, states, transitions, orders, fault }`.
fn exploration_json(reports: &[ExplorationReport]) -> Value {
    let fault = reports.iter().find_map(ExplorationReport::violation);
    let outcome = match (fault, &reports[0].verdict) {
        (Some(_), _) => "wrong",
        (None, ExplorationVerdict::Holds) => "every_order",
        (None, _) => "random_orders",
    };
    json!({
        "outcome": outcome,
        "states": reports[0].states,
        "transitions": reports[0].transitions,
        "orders": reports.get(1).map(|report| report.schedules),
        "fault": fault.map(|fault| fault.what.to_string()),
    })
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
            ExplorationVerdict::Holds => {
                writeln!(
                    out,
                    "  Explored every order of events (equivalent orders once): {visited}."
                )
            }
            ExplorationVerdict::Violated(violation) if report.schedules > 0 => writeln!(
                out,
                "  Random order {} goes wrong: {}.",
                report.schedules + 1,
                violation.what
            ),
            ExplorationVerdict::Violated(violation) => {
                writeln!(out, "  Goes wrong: {}; {visited}.", violation.what)
            }
            ExplorationVerdict::Sampled => writeln!(
                out,
                "  Executed in {} random orders without a fault: {} transitions.",
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
                    "  Too many orders to explore all: stopped after {reached}, without a fault."
                )
            }
            ExplorationVerdict::Unfinished(_) => {
                writeln!(out, "  No random order ended within the bound of work.")
            }
        };
    }
    out
}

/// Returns the message about a violation, with the sequence of events that leads to it. Returns
/// `None` if there is no violation.
fn violation_message(file: &str, tables: &Tables, report: &ExplorationReport) -> Option<String> {
    let violation = report.violation()?;
    Some(format!(
        "error: the event tables of `{}` in {file} go wrong in some order of events\n{violation}help: {MISTAKE}\n",
        tables.assembly
    ))
}
