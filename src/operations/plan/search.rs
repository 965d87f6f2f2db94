//! Search for a plan of a target.
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use stochc_compiler::diagnostic::Severity;
use stochc_compiler::{Limits, LintLevels};
use stochc_grammar::Cancellation;
use stochc_planner::{
    Completion, Goal, PlanSearch, Planned, TargetError, Unplanned, untrue_claims,
};
use stochc_results::now;
use stochc_runtime::rates::Rates;
use stochc_text::visible;

use super::budget::Budget;
use super::goal::goal;
use super::not_planned::NotPlanned;
use super::options::{PlanOptions, PlanScope};
use super::{race, rest};
use crate::exit::Failure;
use crate::host::{Host, during};
use crate::operations::rates::read_rates_for;
use crate::progress::WorkProgress;
use crate::reader::DiskReader;

/// Checks that a completed program has no errors at another path. Its imports are relative, so
/// errors can appear there.
///
/// # Errors
/// If the program has errors at that path. Ignores claims that the plan does not fulfil yet.
pub fn is_right_at(path: &Path, planned: &Planned, imports: &[PathBuf]) -> Result<(), Failure> {
    let text = &planned.text;
    let path = path.to_string_lossy();
    let mut reader = DiskReader::new(&path, Some(text.as_bytes()), imports);
    let (limits, levels) = (Limits::default(), LintLevels::default());
    let checked = stochc_compiler::check_with(&path, &mut reader, limits, &levels);
    if untrue_claims(&checked).is_some_and(|untrue| untrue <= planned.untrue) {
        return Ok(());
    }
    let mut found = checked.diagnostics.iter();
    match found.find(|found| found.severity == Severity::Error) {
        None => Ok(()),
        Some(error) => Err(Failure::usage(format!(
            "in `{}` the program would not be right: {}; write it into the folder of the program that it completes",
            visible(&path),
            error.title
        ))),
    }
}

/// Target of a plan, after reading it.
#[derive(Debug)]
pub enum PlanTarget {
    /// Shape to build, or the structure of a run to complete.
    Goal(Goal),
    /// Partial program to complete.
    Completion(Completion),
}

/// Reads the target of a plan.
///
/// # Errors
/// If the target cannot be read, or contains nothing to plan.
pub fn read(options: &PlanOptions<'_>, host: &dyn Host) -> Result<PlanTarget, NotPlanned> {
    match options.extent {
        PlanScope::Whole => Ok(PlanTarget::Goal(goal(options, host)?)),
        PlanScope::Completion => rest::completion(options, host).map(PlanTarget::Completion),
        PlanScope::Rest(end) => Ok(PlanTarget::Goal(rest::goal(options, &end, host)?)),
    }
}

/// Plans a target.
///
/// # Errors
/// If the target cannot be built, or the user interrupts before the first plan.
pub fn plan(
    read: &PlanTarget,
    options: &PlanOptions<'_>,
    host: &dyn Host,
) -> Result<Planned, NotPlanned> {
    // Planning itself reports errors of the scene.
    let (missing, scene) = match read {
        PlanTarget::Goal(goal) => (goal.cells.len(), goal.scene().ok()),
        PlanTarget::Completion(completion) => {
            (completion.missing(), Some(completion.scene().clone()))
        }
    };
    let is_rest = matches!(options.extent, PlanScope::Rest(_));
    let planar = scene.as_ref().filter(|scene| scene.planar.is_some());
    if let Some(scene) = planar.filter(|_| is_rest) {
        let reason = "has `world planar`, where only whole shapes can be planned";
        return Err(Failure::usage(format!("scene `{}` {reason}", visible(&scene.name))).into());
    }
    let rates = read_rates_for(options.rates, scene.iter(), host)?;
    let typical = |scene| Rates::known_or_guessed(&rates, scene).is_none();
    let is_typical = scene.as_ref().is_some_and(typical);
    let planned = search(missing, is_typical, options, host, |search| match read {
        PlanTarget::Goal(goal) => goal.plan(&rates, search),
        PlanTarget::Completion(completion) => completion.plan(&rates, search),
    })?;
    match (read, options.race) {
        (PlanTarget::Goal(goal), Some(runs)) => {
            let rivals = goal.plans_that_may_jam(&rates, options.seed);
            let rivals = rivals.map_err(|error| NotPlanned::new(error, options, host))?;
            Ok(race::winner(planned, rivals, runs, options, host)?)
        }
        _ => Ok(planned),
    }
}

/// Searches for a plan within the budget. `cells` is the number of cells in the shape. With
/// `is_typical`, estimates only rank plans, and are not shown.
pub(super) fn search(
    cells: usize,
    is_typical: bool,
    options: &PlanOptions<'_>,
    host: &dyn Host,
    plan: impl Fn(PlanSearch<'_>) -> Result<Planned, Unplanned> + Sync,
) -> Result<Planned, NotPlanned> {
    let stop = host.stop();
    let start = now();
    let budget = options.budget.unwrap_or_else(|| Budget::for_cells(cells));
    let (tried, best) = (AtomicU64::new(0), AtomicU64::new(0));
    let is_over = || {
        let is_late = matches!(budget, Budget::Time(time) if start.elapsed() >= time);
        is_late || stop.load(Ordering::Relaxed)
    };
    let is_half_over = || {
        let is_late = matches!(budget, Budget::Time(time) if start.elapsed() >= time / 2);
        is_late || stop.load(Ordering::Relaxed)
    };
    let is_stopped = || stop.load(Ordering::Relaxed);
    let count = |rounds: u64, ticks: f64| {
        tried.store(rounds, Ordering::Relaxed);
        best.store(ticks as u64, Ordering::Relaxed);
    };
    let search = PlanSearch {
        objective: options.objective,
        rounds: budget.tries(),
        seed: options.seed,
        halfway: Cancellation::new(&is_half_over),
        enough: Cancellation::new(&is_over),
        cancellation: Cancellation::new(&is_stopped),
        keeps_scaffolds: options.keeps_scaffolds,
        tried: &count,
    };
    let is_refused = AtomicBool::new(false);
    let state = |elapsed| {
        let tried = tried.load(Ordering::Relaxed);
        WorkProgress {
            share: budget.share(tried, elapsed),
            // If the target cannot be planned, show only the error.
            done: if is_refused.load(Ordering::Relaxed) {
                String::new()
            } else {
                format!("{tried} plans tried")
            },
            more: match best.load(Ordering::Relaxed) {
                0 => String::new(),
                _ if is_typical => String::new(),
                best => format!("; the best takes about {best} ticks"),
            },
        }
    };
    let planned = during(host, state, || {
        let planned = plan(search);
        let refused =
            matches!(&planned, Err(Unplanned::Refused(error)) if *error != TargetError::Cancelled);
        is_refused.store(refused, Ordering::Relaxed);
        planned
    });
    planned.map_err(|unplanned| NotPlanned::new(unplanned, options, host))
}
