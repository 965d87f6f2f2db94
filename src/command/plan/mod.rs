//! `stochc plan`.
mod budget;
mod seed_plate;
mod target;

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use clap::{Args, ValueEnum};
use serde_json::json;
use stochc_files::atomic::{Replaces, replace};
use stochc_grammar::Cancellation;
use stochc_planner::{Objective, Refusal, Search, explanation};

use super::check::verdict;
use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::progress::{Display, State};
use super::results::Form;
use super::terminal::{has_colour, message_width, print, warn, warn_drawn};
use crate::diagnostics::drawn;
use crate::exit::{Exit, Failure};
use crate::planning::{Goal, Planned, Unplanned};
use budget::Budget;
use seed_plate::SeedPlate;

/// What `plan` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// What to build: a program with a shape (`.sa`), a model of MagicaVoxel (`.vox`), or layers drawn as text (`.txt`)
    #[arg(value_name = "TARGET")]
    target: String,
    /// Shape of the program to build [default: the only one, or the last one claimed]
    #[arg(long, value_name = "NAME")]
    shape: Option<String>,
    /// Plate to build on, and those of its blocks that may capture: `3 x 3`, `3 x 3 at (1, 1) (2, 0)`
    /// [default: that of the assembly which claims the shape, or the smallest plate under the shape]
    #[arg(long, value_name = "PLATE", value_parser = SeedPlate::parse)]
    seed_plate: Option<SeedPlate>,
    /// Scene to build in [default: that of the assembly which claims the shape]
    #[arg(long, value_name = "NAME")]
    scene: Option<String>,
    /// Write the program to this file instead of the output
    #[arg(long, value_name = "FILE.sa")]
    out: Option<PathBuf>,
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
    /// Tell the order in words and as a picture, what limits it, and what alternatives would cost
    #[arg(long)]
    explain: bool,
    /// Output format; `json` has the program and its plan in one document
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: Form,
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
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let mut goal = target::read(options)?;
    if let Some(plate) = &options.seed_plate {
        goal.plate = Some(plate.plate.clone());
        goal.seeds = plate.seeds.clone();
    }
    if options.scene.is_some() {
        goal.scene.clone_from(&options.scene);
    }
    let stop = stop_on_interrupt()?;
    let planned = planned(&goal, options)?;
    let stopped = stop.load(Ordering::Relaxed);
    write(&planned, options)?;
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

#[expect(
    clippy::disallowed_methods,
    reason = "a budget of time ends the search for better plans; any that was found is as good"
)]
fn now() -> Instant {
    Instant::now()
}

fn planned(goal: &Goal, options: &Options) -> Result<Planned, Failure> {
    let stop = stop_on_interrupt()?;
    let start = now();
    let budget = options
        .budget
        .unwrap_or_else(|| Budget::of_cells(goal.cells.len()));
    let (tried, best) = (AtomicU64::new(0), AtomicU64::new(0));
    let is_over = || {
        let is_late = matches!(budget, Budget::Time(time) if start.elapsed() >= time);
        is_late || stop.load(Ordering::Relaxed)
    };
    let is_stopped = || stop.load(Ordering::Relaxed);
    let count = |rounds: u64, ticks: f64| {
        tried.store(rounds, Ordering::Relaxed);
        best.store(ticks as u64, Ordering::Relaxed);
    };
    let search = Search {
        objective: match options.minimize {
            Minimize::Mean => Objective::Mean,
            Minimize::P90 => Objective::P90,
        },
        rounds: budget.tries(),
        seed: options.random_seed,
        enough: Cancellation::new(&is_over),
        cancellation: Cancellation::new(&is_stopped),
        tried: &count,
    };
    let state = |elapsed| {
        let tried = tried.load(Ordering::Relaxed);
        State {
            share: budget.share(tried, elapsed),
            done: format!("{tried} plans tried"),
            more: match best.load(Ordering::Relaxed) {
                0 => String::new(),
                best => format!("; the best takes about {best} ticks"),
            },
        }
    };
    let display = Display::on_standard_error(options.quiet);
    let planned = display.during(state, || goal.plan(search));
    planned.map_err(|unplanned| told(&unplanned, options))
}

/// Why there is no plan.
fn told(unplanned: &Unplanned, options: &Options) -> Failure {
    match unplanned {
        Unplanned::Refused(Refusal::Cancelled) => Failure {
            exit: Exit::Interrupted,
            message: "stopped before there was a plan\n".to_owned(),
        },
        Unplanned::Refused(refusal) => {
            let mut reason = format!("`{}`: {refusal}", options.target);
            if let Some(help) = refusal.help() {
                reason += &format!("\nhelp: {help}");
            }
            Failure::wrong_program(reason)
        }
        Unplanned::Wrong(checked) => {
            warn_drawn(&drawn(checked, has_colour(), message_width()));
            Failure::silent(verdict(checked))
        }
    }
}

fn write(planned: &Planned, options: &Options) -> Result<(), Failure> {
    let Planned { plan, text } = planned;
    if let Some(path) = &options.out {
        replace(path, text.as_bytes(), Replaces::Nothing).map_err(|error| {
            Failure::usage(format!("cannot write `{}`: {error}", path.display()))
        })?;
    }
    match (options.format, &options.out) {
        (Form::Json, _) => {
            let document = json!({ "program": text, "plan": plan });
            print(&format!("{document:#}\n"))?;
        }
        (Form::Text, None) => print(text)?,
        (Form::Text, Some(_)) => {}
    }
    if options.explain {
        let told = explanation(plan);
        match (options.format, &options.out) {
            (Form::Text, Some(_)) => print(&told)?,
            // Where the program goes, nothing else does.
            _ => warn(&told),
        }
    }
    Ok(())
}
