//! `stochc plan`.
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::{Args, ValueEnum};
use serde_json::json;
use stochc_planner::{Objective, explanation};

use super::host::Terminal;
use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::new_file::NewFile;
use super::results::ResultsFormat;
use super::run_options::RatesOption;
use super::terminal::{print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::plan::{
    Budget, Offset, PlanOptions, PlanScope, RunEnd, SeedPlate, is_right_at, plan, read,
};
use crate::planning::Planned;

/// What `plan` is given.
#[derive(Debug, Args)]
pub struct PlanArguments {
    /// What to build: a program with a shape (`.sa`), a model of MagicaVoxel (`.vox`), or layers drawn as text (`.txt`); with `--run` the
    /// results folder of the run
    #[arg(value_name = "TARGET")]
    target: String,
    /// Complete the program: plan what is missing where a phase claims a shape that it does not build
    #[arg(long, conflicts_with_all = ["run", "seed_plate", "offset", "scene", "keep_scaffolds"])]
    complete: bool,
    /// Plan the rest of run N of a results folder: what stands at its end is attached by hand in the program, and what does not belong to
    /// the shape is let go
    #[arg(long, value_name = "N", conflicts_with_all = ["seed_plate", "offset", "keep_scaffolds"])]
    run: Option<u64>,
    /// Name of the program of the run; needed if the folder holds several
    #[arg(
        long,
        value_name = "NAME",
        requires = "run",
        conflicts_with = "complete"
    )]
    program: Option<String>,
    /// Name of a block that stands at the end of the run and neither captures nor passes messages on any more; may be given several times
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
    /// Plate to build on, and those of its blocks that may capture: `3 x 3`, `3 x 3 at (1, 1) (2, 0)`
    /// [default: that of the assembly which claims the shape, or the smallest plate under the shape]
    #[arg(long, value_name = "PLATE", value_parser = SeedPlate::parse)]
    seed_plate: Option<SeedPlate>,
    /// Move the shape by so many cells to the east and to the north on the plate, such as `2, 1`
    #[arg(long, value_name = "X, Y", value_parser = Offset::parse, allow_hyphen_values = true)]
    offset: Option<Offset>,
    /// Scene to build in [default: that of the assembly which claims the shape]
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Write the program to this file instead of the output
    #[arg(long, value_name = "FILE.sa")]
    out: Option<PathBuf>,
    #[command(flatten)]
    rates: RatesOption,
    /// How long to look for a better plan: a time, such as 10s or 2m, or a number of tries, of which the same number
    /// always gives the same plan [default: tries for about a second]
    #[arg(long, value_name = "TIME|TRIES", value_parser = Budget::parse)]
    budget: Option<Budget>,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    random_seed: u64,
    /// What to make small: the mean time to completion, or that in which nine runs of ten are complete
    #[arg(long, value_name = "WHAT", default_value = "mean")]
    minimize: Minimize,
    /// Leave scaffolds standing, where the plan has any: the program then claims the shape together with them
    #[arg(long)]
    keep_scaffolds: bool,
    /// Tell the order in words and as a picture, what limits it, and what alternatives would cost
    #[arg(long)]
    explain: bool,
    /// Output format; `json` has the program and its plan in one document
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: ResultsFormat,
    /// Do not show progress
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    imports: ImportOptions,
}

/// What a plan should make small.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Minimize {
    /// The mean time to completion
    Mean,
    /// The time in which nine of ten runs are complete
    P90,
}

/// Plans, and writes the program.
pub fn run(options: &PlanArguments) -> Result<Exit, Failure> {
    let host = Terminal::new(options.quiet);
    let out = options.out.as_deref().map(NewFile::begin).transpose()?;
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
        seed_plate: options.seed_plate.as_ref(),
        offset: options.offset,
        scene: options.scene.as_deref(),
        imports: &options.imports.folders,
        budget: options.budget,
        objective: match options.minimize {
            Minimize::Mean => Objective::Mean,
            Minimize::P90 => Objective::P90,
        },
        seed: options.random_seed,
        keeps_scaffolds: options.keep_scaffolds,
        rates: &options.rates.rates,
    };
    let target = read(&plan_options, &host)?;
    let stop = stop_on_interrupt()?;
    let planned = plan(&target, &plan_options, &host)?;
    let stopped = stop.load(Ordering::Relaxed);
    if let (true, Some(path)) = (options.complete, &options.out) {
        is_right_at(path, &planned, &options.imports.folders)?;
    }
    write(&planned, out, options)?;
    match stopped {
        false => Ok(Exit::Success),
        true => Err(Failure {
            exit: Exit::Interrupted,
            message: format!(
                "stopped; this is the best of {} plans\n",
                planned.plan.rounds
            ),
        }),
    }
}

fn write(planned: &Planned, out: Option<NewFile>, options: &PlanArguments) -> Result<(), Failure> {
    let Planned { plan, text, .. } = planned;
    if let Some(out) = out {
        out.write(text)?;
    }
    match (options.format, &options.out) {
        (ResultsFormat::Json, _) => {
            let document = json!({ "program": text, "plan": plan });
            print(&format!("{document:#}\n"))?;
        }
        (ResultsFormat::Text, None) => print(text)?,
        (ResultsFormat::Text, Some(_)) => {}
    }
    if options.explain {
        let told = explanation(plan);
        match (options.format, &options.out) {
            (ResultsFormat::Text, Some(_)) => print(&told)?,
            // Where the program goes, nothing else does.
            _ => warn(&told),
        }
    }
    Ok(())
}
