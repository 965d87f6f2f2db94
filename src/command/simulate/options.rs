use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use stochc_runtime::{Model, Precision, Reduction, SUBSTEPS};

use super::super::levels::LevelOptions;
use super::super::results::Form;
use super::super::trade::time;
use super::accuracy::accuracy;
use crate::recording::{EVERY, Selection};
use crate::sweep::Axis;

/// What `simulate` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Programs to run; several are compared with each other
    #[arg(value_name = "FILE", required_unless_present = "manifest")]
    pub files: Vec<String>,
    /// Rerun what a manifest says, sources and settings included
    #[arg(long, value_name = "FILE", conflicts_with_all = ["files", "runs", "seed", "model", "substeps", "solver_iterations", "precision", "reduce", "max_ticks"])]
    pub manifest: Option<PathBuf>,
    /// Runs of each program
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub runs: u64,
    /// Vary a number of the scene: `free=50..600/6`, `bond.pull=2..12 N/5 log` or `tick=10,20 ms`;
    /// several are combined, each with each
    #[arg(long, value_name = "NAME=VALUES", value_parser = Axis::parse, conflicts_with_all = ["manifest", "accuracy"])]
    pub sweep: Vec<Axis>,
    /// The seed of all chance
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// What moves the blocks
    #[arg(long, default_value = "rigid")]
    pub model: ModelName,
    /// Steps of the model within a tick: more are more accurate and slower
    #[arg(long, default_value_t = SUBSTEPS, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub substeps: u32,
    /// Work on contacts in a substep: internal steps of Rapier's solver (4 if left out), or the most
    /// rounds of `rigid` (10)
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub solver_iterations: Option<u32>,
    /// Digits of the physics; `double` with `--model rigid` only
    #[arg(long, default_value = "single")]
    pub precision: PrecisionName,
    /// Leave out something that the scene has, to see what it is worth; with `--model rigid` only
    #[arg(long, value_name = "HOW")]
    pub reduce: Option<ReductionName>,
    /// Choose the cheapest setting that is known to be this close to a converged one, such as 5%
    #[arg(long, value_name = "PERCENT", value_parser = accuracy, conflicts_with_all = ["manifest", "model", "substeps", "solver_iterations", "precision", "reduce"])]
    pub accuracy: Option<f64>,
    /// What `stochc trade --out` has measured, for `--accuracy` or to be told about a setting
    #[arg(long, value_name = "DIR", conflicts_with = "manifest")]
    pub trade: Option<PathBuf>,
    /// Time for the measurement that `--accuracy` needs without `--trade`
    #[arg(long, value_name = "TIME", value_parser = time, default_value = "2m", requires = "accuracy", conflicts_with = "trade")]
    pub budget: Duration,
    /// Ticks after which a run is given up, and its time censored
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub max_ticks: u64,
    /// Runs at the same time; all cores if left out
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// A folder for the results, which must be new
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with an ensemble that was interrupted, or with more runs of it
    #[arg(long, requires = "out")]
    pub resume: bool,
    /// Record these runs, for `stochc replay`: 17, 0..4, 0,5,10..12 or all
    #[arg(long, value_name = "RUNS", requires = "out")]
    pub record: Option<Selection>,
    /// Ticks from one recorded place of a block to the next
    #[arg(long, value_name = "TICKS", default_value_t = EVERY, requires = "record", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub record_every: u32,
    /// Do run number N alone, and tell all that happens in it
    #[arg(long, value_name = "N", conflicts_with_all = ["runs", "out", "threads", "bonds"])]
    pub run: Option<u64>,
    /// The form of the table
    #[arg(long, value_name = "FORM", default_value = "text")]
    pub format: Form,
    /// Show the captures as well: waits, entries, where the blocks came from
    #[arg(long)]
    pub bonds: bool,
    /// No progress
    #[arg(long, short)]
    pub quiet: bool,
    /// What becomes of warnings
    #[command(flatten)]
    pub levels: LevelOptions,
}

/// A model of the physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModelName {
    /// Full rigid bodies, by the engine Rapier
    Rapier,
    /// Full rigid bodies, by a kernel made for many blocks that fly far
    Rigid,
    /// No physics: one random capture a tick, for looking at tables at work
    Shuffle,
}

/// Digits of the physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PrecisionName {
    /// 24 bits
    Single,
    /// 53 bits
    Double,
}

/// What is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ReductionName {
    /// Blocks never turn
    NoRotation,
    /// Blocks touch as balls
    Spheres,
    /// Contacts do not hold sideways
    NoFriction,
    /// Free blocks pass through each other
    NoBlockContact,
}

impl From<PrecisionName> for Precision {
    fn from(name: PrecisionName) -> Precision {
        match name {
            PrecisionName::Single => Precision::Single,
            PrecisionName::Double => Precision::Double,
        }
    }
}

impl From<ReductionName> for Reduction {
    fn from(name: ReductionName) -> Reduction {
        match name {
            ReductionName::NoRotation => Reduction::NoRotation,
            ReductionName::Spheres => Reduction::Spheres,
            ReductionName::NoFriction => Reduction::NoFriction,
            ReductionName::NoBlockContact => Reduction::NoBlockContact,
        }
    }
}

impl From<ModelName> for Model {
    fn from(name: ModelName) -> Model {
        match name {
            ModelName::Rapier => Model::Rapier,
            ModelName::Rigid => Model::Rigid,
            ModelName::Shuffle => Model::Shuffle,
        }
    }
}
