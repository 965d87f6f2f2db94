//! One run alone, told event by event.
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_runtime::record::{BondRecord, Origin, Outcome, RunRecord};
use stochc_runtime::{Settings, run as run_once};

use super::super::results::Form;
use super::super::terminal::print;
use super::{Options, Ready, usage};
use crate::cli::Exit;
use crate::ensemble::{Manifest, Program};

/// Does one run of each program.
pub fn run(
    options: &Options,
    manifest: &Manifest,
    programs: &[Ready],
    settings: &Settings,
    number: u64,
    stop: &AtomicBool,
) -> Exit {
    let mut watch = |_, _| match stop.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let mut exit = Exit::Success;
    let mut records = Vec::new();
    for (ready, program) in programs.iter().zip(&manifest.programs) {
        let Ready { tables, scene } = ready;
        let record = run_once(tables, scene, settings, manifest.seed, number, &mut watch);
        let Ok(record) = record else {
            return Exit::Interrupted;
        };
        if record.outcome != Outcome::Completed {
            exit = Exit::UnsuccessfulRun;
        }
        match options.format {
            Form::Text => print(&story(&record, program)),
            Form::Json => records.push(record),
        }
    }
    if options.format == Form::Json {
        match serde_json::to_string_pretty(&records) {
            Ok(text) => print(&format!("{text}\n")),
            Err(error) => return usage(&error.to_string()),
        }
    }
    exit
}

/// A run in lines: a phase, its captures, its end.
fn story(record: &RunRecord, program: &Program) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{}, run {}", program.name, record.run);
    let mut begun = 0;
    for (number, phase) in program.phases.iter().enumerate() {
        let bonds = record
            .bonds
            .iter()
            .filter(|bond| bond.phase.0 as usize == number);
        let bonds: Vec<&BondRecord> = bonds.collect();
        let ended = record.phase_ticks.get(number);
        if ended.is_none() && bonds.is_empty() {
            break;
        }
        let _ = writeln!(out, "  phase {phase}, from tick {begun}");
        for bond in bonds {
            let _ = writeln!(
                out,
                "    tick {:>7}  {}",
                bond.docked,
                capture(bond, program)
            );
        }
        begun += ended.unwrap_or(&0);
    }
    let end = match &record.outcome {
        Outcome::Completed => "complete".to_owned(),
        Outcome::TimedOut { phase } => format!("timed out in phase {}", program.phase(*phase)),
        Outcome::Failed { phase, reason } => {
            format!("failed in phase {}: {reason}", program.phase(*phase))
        }
    };
    let _ = writeln!(
        out,
        "  {end} after {}; {} of {}, {}",
        count(record.ticks, "tick", "ticks"),
        count(record.bonds.len() as u64, "capture", "captures"),
        count(
            record.blocks_used.into(),
            "different block",
            "different blocks"
        ),
        count(record.hops, "message hop", "message hops"),
    );
    if record.unplanned > 0 {
        let bonds = count(record.unplanned, "unplanned bond", "unplanned bonds");
        let _ = writeln!(out, "  {bonds}, undone at once");
    }
    out
}

fn capture(bond: &BondRecord, program: &Program) -> String {
    let origin = match &bond.origin {
        Origin::Free => String::new(),
        Origin::Released { role, tick } => {
            format!(", the former {}, released at {tick}", program.role(*role))
        }
    };
    format!(
        "{}.{} captures {} after {} and {}: block {}{origin}",
        program.role(bond.parent),
        bond.face,
        program.role(bond.child),
        count(bond.docked - bond.magnetized, "tick", "ticks"),
        count(bond.entries.into(), "entry", "entries"),
        bond.body,
    )
}

fn count(n: u64, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
