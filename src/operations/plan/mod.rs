//! Plans a program that builds a shape.
mod budget;
mod offset;
mod pair;
mod race;
mod rest;
mod scene;
mod seed_plate;
mod target;

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use stochc_compiler::diagnostic::Severity;
use stochc_compiler::{Limits, LintLevels};
use stochc_grammar::Cancellation;
use stochc_planner::{LoosePart, Objective, PlanSearch, TargetError, listed_cells};
use stochc_results::now;
use stochc_text::counted;
use stochc_text::visible;

use super::programs::verdict;
use super::rates::of_files_for;
use crate::exit::{Exit, Failure};
use crate::host::{Host, during};
use crate::progress::WorkProgress;
use crate::reader::DiskReader;
use stochc_planner::{Completion, Goal, Planned, Unplanned, untrue_claims};

pub use budget::Budget;
pub use offset::Offset;
pub use race::{MAX_RACE, MIN_RACE};
pub use rest::RunEnd;
pub use seed_plate::SeedPlate;

/// Options of a plan.
#[derive(Clone, Copy, Debug)]
pub struct PlanOptions<'a> {
    /// A program with a shape, a voxel file, or a results folder.
    pub target: &'a str,
    /// The part of the target to plan.
    pub extent: PlanScope<'a>,
    /// Name of the shape in the program. `None` means the only shape, or the one claimed last.
    pub shape: Option<&'a str>,
    /// Number of the model in a `.vox` file to build. `None` means all models, placed as in the
    /// voxel scene.
    pub model: Option<u32>,
    /// The plate to build on. `None` means that of the target.
    pub seed_plate: Option<&'a SeedPlate>,
    /// Displacement of the shape from its position in the target.
    pub offset: Option<Offset>,
    /// The scene to build in, also as `FILE.sa:NAME`. The default is that of the target.
    pub scene: Option<&'a str>,
    /// Number of free blocks. The default is that of the scene.
    pub free: Option<u32>,
    /// Name of the assembly. The default is the name of the shape.
    pub name: Option<&'a str>,
    /// The treatment of loose parts.
    pub loose: LooseParts,
    /// Further folders for imports.
    pub imports: &'a [PathBuf],
    /// Budget of the search. `None` means about one second.
    pub budget: Option<Budget>,
    /// The time to minimize.
    pub objective: Objective,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether scaffolds remain in the structure.
    pub keeps_scaffolds: bool,
    /// Number of runs of each plan in a race. `None` if there is no race.
    pub race: Option<u64>,
    /// Files of rates for scenes without built-in rates.
    pub rates: &'a [PathBuf],
}

/// Reads the shape to build.
///
/// # Errors
/// If the target cannot be read or contains no shape.
fn goal(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let mut goal = target::read(options, host)?;
    scene::choose_declared(&mut goal, options, host);
    if let Some(Offset { east, north }) = options.offset {
        goal = (goal.moved(east, north))
            .ok_or_else(|| Failure::usage("--offset: the shape would be too far from the plate"))?;
    }
    placed(goal, options, host)
}

/// Applies the options for name, plate, offset and scene to a goal.
///
/// # Errors
/// If the scene does not exist, or the name is not a valid name.
fn placed(mut goal: Goal, options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    if let Some(name) = options.name {
        goal.assembly = Some(assembly_name(name, &goal)?);
    }
    if let Some(plate) = options.seed_plate {
        goal.plate = Some(plate.plate.clone());
        goal.seeds = plate.seeds.clone();
    }
    hold_loose(&mut goal, options.loose, host);
    scene::choose(&mut goal, options, host)?;
    Ok(goal)
}

fn assembly_name(name: &str, goal: &Goal) -> Result<String, Failure> {
    let is_taken = name == goal.name || goal.declared_scenes().any(|scene| scene == name);
    match (target::is_name(name), is_taken) {
        (true, false) => Ok(name.to_owned()),
        (true, true) => Err(Failure::usage(format!(
            "--name: `{name}` is the name of the shape or of a scene already"
        ))),
        (false, _) => Err(Failure::usage(format!(
            "--name: `{}` is not a name; give letters, digits and `_`, no digit first and no keyword",
            visible(name)
        ))),
    }
}

/// Treats loose parts as the options require, and reports them.
fn hold_loose(goal: &mut Goal, loose: LooseParts, host: &dyn Host) {
    match loose {
        LooseParts::Refuse => {}
        LooseParts::Drop => {
            let parts = goal.drop_loose();
            let cells: usize = parts.iter().map(|part| part.cells.len()).sum();
            if cells > 0 {
                let (parts, cells) = (counted(parts.len(), "loose part"), counted(cells, "cell"));
                host.warn(&format!("note: left out {parts} with {cells}\n"));
            }
        }
        LooseParts::Support => {
            let supports = goal.add_supports();
            if !supports.is_empty() {
                host.warn(&format!(
                    "note: added {} to support loose parts: {}\n",
                    counted(supports.len(), "cell"),
                    listed_cells(&supports)
                ));
            }
        }
    }
}

/// Checks that a completed program is also correct at another path, because imports are relative.
///
/// # Errors
/// If the program has errors at that path. Claims that the plan does not fulfil yet are ignored.
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

/// Treatment of parts that are not attached to a block that can capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LooseParts {
    /// Reject the target.
    #[default]
    Refuse,
    /// Leave the parts out.
    Drop,
    /// Add cells that support the parts.
    Support,
}

impl LooseParts {
    /// Combines the two options. At most one of them is given.
    pub fn new(are_dropped: bool, are_supported: bool) -> LooseParts {
        if are_dropped {
            LooseParts::Drop
        } else if are_supported {
            LooseParts::Support
        } else {
            LooseParts::Refuse
        }
    }
}

/// The part of a target to plan.
#[derive(Clone, Copy, Debug, Default)]
pub enum PlanScope<'a> {
    /// The whole shape.
    #[default]
    Whole,
    /// The captures that are missing in a program.
    Completion,
    /// The blocks that are missing at the end of a run.
    Rest(RunEnd<'a>),
}

impl<'a> PlanScope<'a> {
    /// Returns the part to plan: the rest of a run if given, else the completion of a program, else
    /// the whole shape.
    pub fn new(rest: Option<RunEnd<'a>>, completes: bool) -> PlanScope<'a> {
        match rest {
            Some(end) => PlanScope::Rest(end),
            None if completes => PlanScope::Completion,
            None => PlanScope::Whole,
        }
    }
}

/// A target that has been read.
#[derive(Debug)]
pub enum PlanTarget {
    /// A shape, or the rest of a run.
    Goal(Goal),
    /// A partial program.
    Completion(Completion),
}

/// Reads the target.
///
/// # Errors
/// If it cannot be read, or contains nothing to plan.
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
    // The plan reports errors of a scene.
    let (missing, scene) = match read {
        PlanTarget::Goal(goal) => (goal.cells.len(), goal.scene().ok()),
        PlanTarget::Completion(completion) => {
            (completion.missing(), Some(completion.scene().clone()))
        }
    };
    let rates = of_files_for(options.rates, scene.iter(), host)?;
    let planned = search(missing, options, host, |search| match read {
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

/// Searches for a plan of this number of cells within the budget.
fn search(
    cells: usize,
    options: &PlanOptions<'_>,
    host: &dyn Host,
    plan: impl Fn(PlanSearch<'_>) -> Result<Planned, Unplanned> + Sync,
) -> Result<Planned, NotPlanned> {
    let stop = host.stop();
    let start = now();
    let budget = options.budget.unwrap_or_else(|| Budget::of_cells(cells));
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
            // If the target cannot be planned, the error is sufficient.
            done: if is_refused.load(Ordering::Relaxed) {
                String::new()
            } else {
                format!("{tried} plans tried")
            },
            more: match best.load(Ordering::Relaxed) {
                0 => String::new(),
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

/// Returns the error that a target cannot be planned for this reason.
fn refused(target: &str, reason: impl Display) -> Failure {
    Failure::error(Exit::InvalidProgram, format!("`{target}`: {reason}"))
}

/// Returns the error that a target cannot be built, with the options that help.
fn impossible(options: &PlanOptions<'_>, error: &TargetError) -> Failure {
    let mut failure = refused(options.target, error);
    // Blocks of an existing structure cannot be left out.
    let stands =
        matches!(error, TargetError::Sealed(_)) && !matches!(options.extent, PlanScope::Whole);
    if let Some(help) = error.help().filter(|_| !stands) {
        let option = option_for(error, options.extent);
        failure.message += &format!("help: {}{option}\n", visible(&help));
    }
    failure
}

/// Returns a hint with the options that help.
fn option_for(error: &TargetError, extent: PlanScope<'_>) -> &'static str {
    match (error, extent) {
        (TargetError::Loose(parts), PlanScope::Whole)
            if parts.iter().any(LoosePart::rests_on_plate) =>
        {
            " (`--plate`, `--offset`); `--supports` adds such cells, `--drop-loose` leaves the parts out"
        }
        (TargetError::Loose(_), PlanScope::Whole) => {
            "; `--supports` adds such cells, `--drop-loose` leaves the parts out"
        }
        (TargetError::TooFewBlocks { .. }, PlanScope::Whole | PlanScope::Rest(_)) => {
            " (`--free`, `--scene`)"
        }
        _ => "",
    }
}

/// The reason why there is no plan.
#[derive(Debug)]
pub struct NotPlanned {
    /// Message and exit status of the command.
    pub failure: Failure,
    /// The error in the target. `None` if something else failed.
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
    fn impossible(options: &PlanOptions<'_>, error: TargetError) -> NotPlanned {
        NotPlanned {
            failure: impossible(options, &error),
            refused: Some(error),
        }
    }

    fn new(unplanned: Unplanned, options: &PlanOptions<'_>, host: &dyn Host) -> NotPlanned {
        match unplanned {
            Unplanned::Refused(TargetError::Cancelled) => NotPlanned::from(Failure {
                exit: Exit::Interrupted,
                message: "stopped before there was a plan\n".to_owned(),
            }),
            Unplanned::Refused(error) => NotPlanned::impossible(options, error),
            Unplanned::Wrong(checked) => {
                // A denied warning also prevents a program.
                NotPlanned::from(Failure {
                    exit: Exit::InvalidProgram.or_worse(verdict(&checked)),
                    message: host.draw(&checked),
                })
            }
        }
    }
}
