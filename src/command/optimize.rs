//! `stochc optimize`.
use std::path::PathBuf;

use clap::Args;
use serde_json::json;
use stochc_experiments::fit::Prior;
use stochc_experiments::optimize::{Constraint, Goal, Objective};
use stochc_files::atomic::{self, Replaces};
use stochc_report::tables::optima_to_text;
use stochc_results::MAX_RUNS;

use super::ensemble::ProgramOptions;
use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::run_options::{JsonOption, ThreadsOption};
use super::terminal::{argument, close, output_width, print};
use crate::exit::{Exit, Failure};
use crate::operations::forecast::forecast_to_text;
use crate::operations::json::document;
use crate::operations::optimize::{OptimizeSetup, forecast, optimize};
use crate::operations::programs::programs;
use crate::operations::rates::read_rates_for;

/// Arguments of `optimize`.
#[derive(Debug, Args)]
pub struct OptimizeArguments {
    #[command(flatten)]
    programs: ProgramOptions,
    /// Parameter to optimize, and its range. Examples: `agitation.speed=0.4..1.2 m/s` and `height=2..6` and `free=50..500 log`
    #[arg(long, value_name = "NAME=RANGE", required = true, help_heading = "Search", value_parser = Prior::parse)]
    vary: Vec<Prior>,
    /// Quantity to minimize: the `mean` time, a quantile such as `p90`, or a probability such as `P(T > 8000)` with a
    /// time in ticks
    #[arg(long, value_name = "OBJECTIVE", default_value = "mean", help_heading = "Search", value_parser = Objective::parse)]
    minimize: Objective,
    /// Constraint of the optimum, such as `p90 <= 7000` or `P(T > 8000) <= 0.05`. If given several times, all must hold
    #[arg(long, value_name = "CONSTRAINT", help_heading = "Search", value_parser = Constraint::parse)]
    subject_to: Vec<Constraint>,
    /// Largest number of runs of each program that search for the optimum
    #[arg(long, short = 'n', value_name = "N", default_value_t = 200, help_heading = "Search", value_parser = clap::value_parser!(u64).range(1..=MAX_RUNS))]
    runs: u64,
    /// Number of runs with another seed that confirm the optimum, 10 to 10,000. Each elasticity takes twice as many
    #[arg(long, value_name = "N", default_value_t = 50, help_heading = "Search", value_parser = clap::value_parser!(u64).range(10..=10_000))]
    confirm: u64,
    #[command(flatten)]
    work: ThreadsOption,
    /// Folder for all runs and `optimum.json`. If the command was stopped, run it again to continue
    #[arg(long, short, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Print the expected CPU time, and simulate nothing
    #[arg(long, help_heading = "Output")]
    dry_run: bool,
    #[command(flatten)]
    output: JsonOption,
}

pub fn run(options: &OptimizeArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let given = &options.programs;
    let settings = given.model.settings();
    given.model.are_used(&settings)?;
    let settings = settings.resolved();
    let mut source = given.source.settings();
    source.levels = source.levels.for_runs(settings.stepping());
    let programs = programs(&given.files, &source, &host)?;
    let scenes = programs.iter().map(|it| &it.scene);
    let rates = read_rates_for(&given.model.rates, scenes, &host)?;
    let setup = OptimizeSetup {
        priors: &options.vary,
        goal: Goal {
            objective: options.minimize,
            constraints: &options.subject_to,
        },
        runs: options.runs,
        confirm: options.confirm,
        settings,
        rates: &rates,
        seed: given.chance.seed,
        threads: options.work.threads,
        levels: &source.levels,
        out: options.out.as_deref(),
    };
    stop_on_interrupt()?;
    if options.dry_run {
        let forecast = forecast(&setup, &programs, &host)?;
        print(&forecast_to_text(&forecast, setup.threads))?;
        return Ok(Exit::Success);
    }
    if let Some(out) = &options.out {
        atomic::make_folder(out).map_err(|error| Failure::not_written(out, error))?;
    }
    let optima = optimize(&setup, &programs, &host)?;
    let json = document(json!({ "optima": optima }));
    if options.output.json {
        print(&json)?;
    } else {
        print(&optima_to_text(&optima, &options.vary, output_width()))?;
    }
    if let Some(out) = &options.out {
        let path = out.join("optimum.json");
        atomic::replace(&path, json.as_bytes(), Replaces::Ordinary)
            .map_err(|error| Failure::not_written(&path, error))?;
        let confirmation = argument(&out.join("confirmation"));
        close(&format!(
            "Saved in {}. Next: stochc show {confirmation}\n",
            argument(out)
        ));
    }
    Ok(Exit::from_runs(optima.iter().all(|it| {
        it.stopped_confirming == 0 && it.satisfies_constraints()
    })))
}
