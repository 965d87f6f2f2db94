//! Options that commands for ensembles share.
use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use stochc_results::recording::{EVERY, Selection};
use stochc_results::{Interval, MAX_RUNS};
use stochc_runtime::{Model, Precision, Reduction, Setting, Settings, Substeps};
use stochc_text::share;

use super::super::run_options::{ResultsOptions, SeedOption, ThreadsOption};
use super::super::source_options::SourceOptions;
use crate::exit::Failure;

/// Default number of runs of each program.
pub const RUNS: u64 = 50;

/// Default limit on the number of runs of each program with `--until`.
pub const MAX_UNTIL: u64 = 10_000;

/// Default limit on the ticks of a run.
pub const MAX_TICKS: u64 = 1_000_000;

/// Options for the programs, and for how each run is computed.
#[derive(Debug, Args)]
pub struct ProgramOptions {
    /// Programs to simulate, or folders that contain programs (`*.sa`)
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<String>,
    #[command(flatten)]
    pub chance: SeedOption,
    #[command(flatten)]
    pub model: ModelOptions,
    #[command(flatten)]
    pub source: SourceOptions,
}

/// Options that select how each run is computed.
#[derive(Debug, Args)]
#[command(next_help_heading = "Model")]
pub struct ModelOptions {
    /// Model of the motion of blocks [default: rigid]
    #[arg(long, value_parser = one_of(&Model::ALL, Model::name, Model::meaning))]
    model: Option<Model>,
    /// File with the rates of a scene for `--model rate`, written by `stochc calibrate`. Missing rates are measured before
    /// the runs, except for scenes whose rates need a held-out error
    #[arg(long, value_name = "FILE.rates")]
    pub rates: Vec<PathBuf>,
    /// Time steps per tick. `2/8` means eight steps for blocks near open faces, and two for all other blocks. Scenes with a
    /// fluid, a flow or `bond reject` take eight steps for all blocks [default: 2/8]
    #[arg(long, value_name = "STEPS")]
    substeps: Option<Substeps>,
    /// Iterations of the contact solver per step [default: 4 for `rapier`, up to 10 for `rigid`]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    solver_iterations: Option<u32>,
    /// Floating-point precision. `double` needs `--model rigid` [default: single]
    #[arg(long, value_parser = one_of(&Precision::ALL, Precision::name, Precision::meaning))]
    precision: Option<Precision>,
    /// Leave out a part of the physics to measure its effect. This needs `--model rigid`
    #[arg(long, value_name = "PART", value_parser = one_of(&Reduction::ALL, Reduction::name, Reduction::meaning))]
    without: Option<Reduction>,
    /// Stop each run after this many ticks. A stopped run counts as incomplete (right-censored)
    #[arg(long, value_name = "TICKS", default_value_t = MAX_TICKS, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
}

impl ModelOptions {
    /// Returns the settings that the options choose, without rates.
    pub fn settings(&self) -> Settings {
        let usual = Settings::default();
        Settings {
            model: self.model.unwrap_or(usual.model),
            solver_iterations: self.solver_iterations,
            precision: self.precision.unwrap_or(usual.precision),
            reduction: self.without,
            max_ticks: Some(self.max_ticks),
            ..usual.with_steps(self.substeps.unwrap_or(Substeps::DEFAULT))
        }
    }

    /// Returns whether the command line contains the option for a setting. `axis` is the name of
    /// the setting in a sweep.
    pub fn gives(&self, axis: &str) -> bool {
        match axis {
            "model" => self.model.is_some(),
            "substeps" => self.substeps.is_some(),
            "solver-iterations" => self.solver_iterations.is_some(),
            "precision" => self.precision.is_some(),
            "without" => self.without.is_some(),
            _ => false,
        }
    }

    /// Returns an error if the model does not use one of the given options.
    pub fn are_used(&self, settings: &Settings) -> Result<(), Failure> {
        let model = settings.model;
        // Options with their default value are accepted for every model.
        let steps = self.substeps.map(|_| Setting::Steps);
        let rates = (!self.rates.is_empty()).then_some(Setting::Rates);
        let given = steps.into_iter().chain(settings.chosen()).chain(rates);
        let has_no = |option| Err(format!("no `--{option}`; `--model rigid` has it"));
        let used = match model.unused(given) {
            None => Ok(()),
            Some(Setting::Steps) => has_no("substeps"),
            Some(Setting::SolverIterations) => has_no("solver-iterations"),
            Some(Setting::Precision) => has_no("precision"),
            Some(Setting::Reduction) => has_no("without"),
            Some(Setting::Rates) => {
                Err("no use for `--rates`; they are for `--model rate`".to_owned())
            }
        };
        used.map_err(|what| Failure::usage(format!("the model `{}` has {what}", model.name())))
    }
}

/// Options of the runs of an ensemble and of their results. Commands with these options also have
/// an argument `out`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Runs")]
pub struct MakingOptions {
    /// Number of runs of each program. With `--until`, the maximum [default: 50, or 10000 with `--until`]
    #[arg(long, short = 'n', value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_RUNS))]
    pub runs: Option<u64>,
    /// Add runs until the mean time of every program is known to this precision, such as 3%. The precision is the half-width
    /// of the 95 % confidence interval
    #[arg(long, value_name = "PERCENT", value_parser = share, requires = "out", conflicts_with_all = ["record", "watch"])]
    pub until: Option<f64>,
    #[command(flatten)]
    pub work: ThreadsOption,
    /// Save running simulations at this interval. It is a time (90s, 5m, 2h), a number of ticks (20000ticks) or `never`.
    /// Simulations with `rapier` are not saved
    #[arg(long, value_name = "EVERY", default_value_t = Interval::DEFAULT, requires = "out", help_heading = "Output")]
    pub checkpoints: Interval,
    /// Record the trajectories of these runs for `stochc replay`. Examples: 17 or 0..4 or 0,5,10..12 or all
    #[arg(long, value_name = "RUNS", requires = "out", help_heading = "Output")]
    pub record: Option<Selection>,
    /// Interval of recorded positions, in ticks
    #[arg(long, value_name = "TICKS", default_value_t = EVERY, requires = "record", help_heading = "Output", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub record_every: u32,
    /// Write `report.html` in the folder, and update it every few seconds
    #[arg(long, requires = "out", help_heading = "Output")]
    pub watch: bool,
    /// Print the expected CPU time, and simulate nothing
    #[arg(long, conflicts_with_all = ["watch", "captures"])]
    pub dry_run: bool,
    #[command(flatten)]
    pub shown: ResultsOptions,
}

/// Returns a parser that accepts the name of each value in `all`. `meaning` returns the help text
/// of a value.
fn one_of<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
    meaning: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let values = all.iter();
    let values = values.map(|&value| PossibleValue::new(name(value)).help(meaning(value)));
    PossibleValuesParser::new(values).map(move |word| {
        let mut named = all.iter().copied();
        named
            .find(|&value| name(value) == word)
            .expect("it is one of them")
    })
}
