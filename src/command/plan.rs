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
    /// File with the shape to build: a program with a shape (`.sa`), a MagicaVoxel model (`.vox`), or layers drawn as text
    /// (`.txt`). With `--run`, the results folder of the run
    #[arg(value_name = "TARGET")]
    target: String,
    /// Complete the program. This adds the missing captures to the phase that claims the shape
    #[arg(long, conflicts_with_all = ["run", "plate", "offset", "scene", "keep_scaffolds"])]
    complete: bool,
    /// Write a program that finishes run N of a results folder. It starts from the structure at the end of the run, and
    /// releases blocks outside the shape
    #[arg(long, value_name = "N", conflicts_with_all = ["plate", "offset", "keep_scaffolds"])]
    run: Option<u64>,
    /// Name of the program of the run. Needed if the folder contains several programs
    #[arg(
        long,
        value_name = "NAME",
        requires = "run",
        conflicts_with = "complete"
    )]
    program: Option<String>,
    /// Name of a broken block. A broken block cannot capture, and does not pass messages on. Can be repeated
    #[arg(
        long,
        value_name = "NAME",
        requires = "run",
        conflicts_with = "complete"
    )]
    dead: Vec<String>,
    /// Name of the shape to build, if the program has several [default: the last shape that a phase claims]
    #[arg(long, value_name = "NAME")]
    shape: Option<String>,
    /// Build only this model of a `.vox` file, for example one frame of an animation. Models are counted from 0
    #[arg(long, value_name = "N", conflicts_with_all = ["run", "complete"])]
    model: Option<u32>,
    /// Size of the plate, and its blocks that may capture. Examples: `3 x 3`, or `3 x 3 at (1, 1) (2, 0)`
    /// [default: the plate of the assembly that claims the shape, or the smallest plate under the shape]
    #[arg(long, value_name = "PLATE", value_parser = SeedPlate::parse)]
    plate: Option<SeedPlate>,
    /// Move the shape on the plate by this many cells to the east and north, such as `2, 1`
    #[arg(long, value_name = "X, Y", value_parser = Offset::parse, allow_hyphen_values = true)]
    offset: Option<Offset>,
    /// Leave out loose parts. A part is loose if it is not connected to a block of the plate that may capture
    #[arg(long, conflicts_with_all = ["supports", "run", "complete"])]
    drop_loose: bool,
    /// Add the fewest cells that support all loose parts
    #[arg(long, conflicts_with_all = ["run", "complete"])]
    supports: bool,
    /// Name of the scene to build in, or `FILE.sa:NAME` for a scene of another file [default: the scene of the assembly that
    /// claims the shape, the only scene of the file, or a scene with enough blocks]
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Number of free blocks. The program declares a scene with this number and, if possible, the same density
    #[arg(long, value_name = "N", conflicts_with = "complete", value_parser = clap::value_parser!(u32).range(1..))]
    free: Option<u32>,
    /// Name of the assembly to write [default: `build_` and the name of the shape]
    #[arg(long, value_name = "NAME", conflicts_with = "complete")]
    name: Option<String>,
    /// File for the program [default: print the program]
    #[arg(long, short, value_name = "FILE.sa")]
    out: Option<PathBuf>,
    /// Replace the file of `--out` if an earlier `stochc plan` wrote it
    #[arg(long, requires = "out", conflicts_with = "complete")]
    force: bool,
    #[command(flatten)]
    rates: RatesOption,
    /// Time to search for better plans, such as 10s or 2m [default: about one second]
    #[arg(long, value_name = "TIME", value_parser = time, conflicts_with = "tries")]
    time: Option<Duration>,
    /// Number of tries to find better plans. The same number always gives the same plan
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    tries: Option<u64>,
    #[command(flatten)]
    chance: SeedOption,
    /// Time to minimize
    #[arg(long, value_name = "WHAT", default_value = "mean")]
    minimize: Minimize,
    /// Do not release scaffolds at the end. The program claims the shape together with its scaffolds
    #[arg(long)]
    keep_scaffolds: bool,
    /// Simulate the plan and several simple plans with physics, at most N runs each, and write the fastest one. Blocks may
    /// jam in this plan
    #[arg(long, value_name = "N", conflicts_with_all = ["run", "complete"], value_parser = clap::value_parser!(u64).range(MIN_RACE..=MAX_RACE))]
    race: Option<u64>,
    /// Print a picture of the plan, the reasons for its order, and the cost of alternatives
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
        let exists = path.symlink_metadata().is_ok_and(|it| it.is_file());
        if exists && !options.complete {
            let reason =
                "the file exists; choose another name, or add `--force` to replace an earlier plan";
            return Err(Failure::not_written(path, reason));
        }
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
