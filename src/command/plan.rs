//! `stochc plan`.
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::{Args, ValueEnum};
use serde_json::json;
use stochc_files::atomic::{Replaces, holds};
use stochc_planner::{Objective, PLANNED_MARK, explanation};

use super::host::Terminal;
use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::new_file::NewFile;
use super::run_options::{JsonOption, RatesOption, SeedOption};
use super::terminal::{argument, close, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::json::document;
use crate::operations::plan::{
    Budget, LooseParts, MAX_RACE, MIN_RACE, NotPlanned, Offset, PlanOptions, PlanScope, RunEnd,
    SeedPlate, is_right_at, plan, read,
};
use crate::operations::time;
use stochc_planner::Planned;

/// Arguments of `plan`.
#[derive(Debug, Args)]
pub struct PlanArguments {
    /// Shape to build: a program with a shape (`.sa`), a MagicaVoxel scene (`.vox`), or layers
    /// drawn as text (`.txt`); with `--run` the results folder of the run
    #[arg(value_name = "TARGET")]
    target: String,
    /// Complete the program: add the captures that a phase needs to build the shape that it claims
    #[arg(long, conflicts_with_all = ["run", "plate", "offset", "scene", "keep_scaffolds"])]
    complete: bool,
    /// Plan the rest of run N of a results folder: the program starts from the blocks at its end,
    /// and releases blocks outside the shape
    #[arg(long, value_name = "N", conflicts_with_all = ["plate", "offset", "keep_scaffolds"])]
    run: Option<u64>,
    /// Name of the program of the run; needed if the folder holds several
    #[arg(
        long,
        value_name = "NAME",
        requires = "run",
        conflicts_with = "complete"
    )]
    program: Option<String>,
    /// Name of a block at the end of the run that is broken: it neither captures nor passes
    /// messages on; may be repeated
    #[arg(
        long,
        value_name = "NAME",
        requires = "run",
        conflicts_with = "complete"
    )]
    dead: Vec<String>,
    /// Shape of the program to build [default: the only one, or the last one claimed]
    #[arg(long, value_name = "NAME")]
    shape: Option<String>,
    /// Build only this model of a `.vox` file, counted from 0: one frame of an animation, for instance
    #[arg(long, value_name = "N", conflicts_with_all = ["run", "complete"])]
    model: Option<u32>,
    /// Plate to build on, and its blocks that may capture: `3 x 3`, `3 x 3 at (1, 1) (2, 0)`
    /// [default: that of the assembly with the shape, or the smallest plate under the shape]
    #[arg(long, value_name = "PLATE", value_parser = SeedPlate::parse)]
    plate: Option<SeedPlate>,
    /// Move the shape on the plate by this many cells to the east and north, such as `2, 1`
    #[arg(long, value_name = "X, Y", value_parser = Offset::parse, allow_hyphen_values = true)]
    offset: Option<Offset>,
    /// Leave out parts that are not attached to a block of the plate that may capture
    #[arg(long, conflicts_with_all = ["supports", "run", "complete"])]
    drop_loose: bool,
    /// Add the fewest cells that support such parts
    #[arg(long, conflicts_with_all = ["run", "complete"])]
    supports: bool,
    /// Scene to build in, also of another file: `FILE.sa:NAME` [default: that of the assembly with
    /// the shape, the only one of the file, or one with enough blocks]
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Number of free blocks; the program gets a scene of the same density with this number
    #[arg(long, value_name = "N", conflicts_with = "complete", value_parser = clap::value_parser!(u32).range(1..))]
    free: Option<u32>,
    /// Name of the assembly [default: `build_` and the name of the shape]
    #[arg(long, value_name = "NAME", conflicts_with = "complete")]
    name: Option<String>,
    /// Write the program to this file instead of the output
    #[arg(long, short, value_name = "FILE.sa")]
    out: Option<PathBuf>,
    /// Replace the file of `--out` if `stochc plan` wrote it
    #[arg(long, requires = "out", conflicts_with = "complete")]
    force: bool,
    #[command(flatten)]
    rates: RatesOption,
    /// Search for a better plan during this time, such as 10s or 2m [default: about one second]
    #[arg(long, value_name = "TIME", value_parser = time, conflicts_with = "tries")]
    time: Option<Duration>,
    /// Search for a better plan with this number of tries; the same number always gives the same plan
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    tries: Option<u64>,
    #[command(flatten)]
    chance: SeedOption,
    /// Time to minimize: the mean completion time, or its 90 % quantile
    #[arg(long, value_name = "WHAT", default_value = "mean")]
    minimize: Minimize,
    /// Keep scaffolds: the program claims the shape together with them
    #[arg(long)]
    keep_scaffolds: bool,
    /// Simulate the plan and the plans of simple strategies with physics, at most N runs each, and
    /// write the fastest; jams are allowed
    #[arg(long, value_name = "N", conflicts_with_all = ["run", "complete"], value_parser = clap::value_parser!(u64).range(MIN_RACE..=MAX_RACE))]
    race: Option<u64>,
    /// Describe the order, what limits it, and the cost of alternatives, with a picture
    #[arg(long)]
    explain: bool,
    #[command(flatten)]
    output: JsonOption,
    #[command(flatten)]
    imports: ImportOptions,
}

/// The time to minimize.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Minimize {
    /// The mean completion time
    Mean,
    /// The 90 % quantile of the completion time
    P90,
}

/// Plans a program and writes it.
pub fn run(options: &PlanArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let out = options.out.as_deref();
    let out = out.map(|path| begin(path, options)).transpose()?;
    let plan_options = PlanOptions {
        target: &options.target,
        extent: PlanScope::new(
            options.run.map(|run| RunEnd {
                run,
                program: options.program.as_deref(),
                dead: &options.dead,
            }),
            options.complete,
        ),
        shape: options.shape.as_deref(),
        model: options.model,
        seed_plate: options.plate.as_ref(),
        offset: options.offset,
        scene: options.scene.as_deref(),
        free: options.free,
        name: options.name.as_deref(),
        loose: LooseParts::new(options.drop_loose, options.supports),
        imports: &options.imports.folders,
        budget: (options.time.map(Budget::Time)).or(options.tries.map(Budget::Tries)),
        objective: match options.minimize {
            Minimize::Mean => Objective::Mean,
            Minimize::P90 => Objective::P90,
        },
        seed: options.chance.seed,
        keeps_scaffolds: options.keep_scaffolds,
        race: options.race,
        rates: &options.rates.rates,
    };
    let stop = stop_on_interrupt()?;
    let planned = read(&plan_options, &host)
        .and_then(|target| plan(&target, &plan_options, &host))
        .or_else(|not_planned| report(not_planned, options))?;
    let stopped = stop.load(Ordering::Relaxed);
    if let (true, Some(path)) = (options.complete, &options.out) {
        is_right_at(path, &planned, &options.imports.folders)?;
    }
    write(&planned, out, options)?;
    if let Some(path) = &options.out {
        let file = argument(path);
        close(&format!("Saved in {file}. Next: stochc check {file}\n"));
    }
    if !stopped {
        Ok(Exit::Success)
    } else {
        Err(Failure {
            exit: Exit::Interrupted,
            message: format!(
                "stopped; this is the best of {} plans\n",
                planned.plan.rounds
            ),
        })
    }
}

/// Opens the output file. Returns an error if it is also the target of the plan.
fn begin(path: &Path, options: &PlanArguments) -> Result<NewFile, Failure> {
    if !options.force {
        return NewFile::begin(path, Replaces::Nothing);
    }
    let real = |path: &Path| path.canonicalize().ok();
    let is_target = real(path).is_some_and(|out| real(Path::new(&options.target)) == Some(out));
    if is_target {
        return Err(Failure::usage(format!(
            "`{}` is the target: write the program to another file",
            path.display()
        )));
    }
    let ours = Replaces::Ours(|file| holds(file, PLANNED_MARK.as_bytes()));
    NewFile::begin(path, ours)
}

/// Reports an error in the target of a plan. Reports it as JSON if requested.
fn report(not_planned: NotPlanned, options: &PlanArguments) -> Result<Planned, Failure> {
    if let (true, Some(error)) = (options.output.json, &not_planned.refused) {
        let mut content = json!(error);
        content["message"] = json!(error.to_string());
        print(&document(json!({ "error": content })))?;
    }
    Err(not_planned.into())
}

fn write(planned: &Planned, out: Option<NewFile>, options: &PlanArguments) -> Result<(), Failure> {
    let Planned { plan, text, .. } = planned;
    if let Some(out) = out {
        out.write(text)?;
    }
    match (options.output.json, &options.out) {
        (true, _) => {
            let content = json!({ "program": text, "scene": planned.scene, "plan": plan });
            print(&document(content))?;
        }
        (false, None) => print(text)?,
        (false, Some(_)) => {}
    }
    if options.explain {
        let explanation = explanation(plan);
        match (options.output.json, &options.out) {
            (false, Some(_)) => print(&explanation)?,
            // If standard output has the program, the description of the plan goes to standard
            // error.
            _ => warn(&explanation),
        }
    }
    Ok(())
}
