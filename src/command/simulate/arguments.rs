use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use stochc_ensemble::recording::{EVERY, Selection};
use stochc_ensemble::sweep::Axis;
use stochc_ensemble::text::share;
use stochc_ensemble::{Interval, MAX_RUNS};
use stochc_runtime::{Model, Precision, Reduction, Substeps};

use super::super::figures::FigureOptions;
use super::super::imports::ImportOptions;
use super::super::levels::LevelOptions;
use super::super::run_options::{SeedOption, WorkOptions};
use super::super::show::ResultsFormat;

/// Runs of each program, unless the user says otherwise.
pub const RUNS: u64 = 50;

/// The most of them with `--until`, unless the user says otherwise.
pub const MAX_UNTIL: u64 = 10_000;

/// Ticks after which a run is stopped, unless the user says otherwise.
pub const MAX_TICKS: u64 = 1_000_000;

/// What draws no figures.
const WITHOUT_FIGURES: [&str; 2] = ["shards", "run"];

/// What `simulate` is given.
///
/// An option that `requires` another one conflicts with whatever that one conflicts with: it is not required beside these.
#[derive(Debug, Args)]
#[command(
    mut_arg("seed", |it| it.requires("files")),
    mut_arg("figures", |it| it.requires("out").conflicts_with_all(WITHOUT_FIGURES)),
    mut_arg("figure_format", |it| it.requires("out").conflicts_with_all(WITHOUT_FIGURES))
)]
pub struct SimulateArguments {
    /// Programs to simulate; several are compared with each other
    #[arg(value_name = "FILE", required_unless_present_any = ["manifest", "resume"])]
    pub files: Vec<String>,
    /// Repeat the runs of a `manifest.json`, with the sources and settings in it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["files", "seed", "model", "substeps", "solver_iterations", "precision", "reduce", "max_ticks"])]
    pub manifest: Option<PathBuf>,
    /// Number of runs of each program; with `--until` the most there may be [default: 50; 10000 with `--until`; else of what
    /// is repeated or gone on with, as many as it has]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=MAX_RUNS))]
    pub runs: Option<u64>,
    /// Make runs until half of the 95 % interval of every program's mean is at most PERCENT of it, such as 3%
    #[arg(long, value_name = "PERCENT", value_parser = share, requires = "out", conflicts_with_all = ["shards", "run", "record", "watch"])]
    pub until: Option<f64>,
    /// Vary a scene parameter or a setting: `free=50..600/6`, `bond.pull=2..12 N/5 log` or `substeps=1,2,4`;
    /// with several, every combination is simulated
    #[arg(long, value_name = "NAME=VALUES", value_parser = Axis::parse, requires = "files", conflicts_with = "manifest")]
    pub sweep: Vec<Axis>,
    /// Of all runs.
    #[command(flatten)]
    pub chance: SeedOption,
    /// Physical model
    #[arg(long, default_value = "rigid", requires = "files", value_parser = one_of(&Model::ALL, Model::name, Model::meaning))]
    pub model: Model,
    /// Rates of scenes, by `stochc calibrate --out`, for `--model rate`; scenes that no file is about are measured first
    #[arg(
        long,
        value_name = "FILE.rates",
        requires = "files",
        conflicts_with = "manifest"
    )]
    pub rates: Vec<PathBuf>,
    /// Steps of the model in each tick: more are more accurate and slower; `1/8`: one, and eight for
    /// blocks near magnetized faces [default: 2/8]
    #[arg(long, value_name = "STEPS", requires = "files")]
    pub substeps: Option<Substeps>,
    /// Iterations of the contact solver in each substep [default: 4 for `rapier`, at most 10 for
    /// `rigid`]
    #[arg(long, requires = "files", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub solver_iterations: Option<u32>,
    /// Floating-point precision; `double` needs `--model rigid`
    #[arg(long, default_value = "single", requires = "files", value_parser = one_of(&Precision::ALL, Precision::name, Precision::meaning))]
    pub precision: Precision,
    /// Leave out a part of the physics, to see what it contributes; needs `--model rigid`
    #[arg(long, value_name = "HOW", requires = "files", value_parser = one_of(&Reduction::ALL, Reduction::name, Reduction::meaning))]
    pub reduce: Option<Reduction>,
    /// Stop a run after this many ticks; its time is then censored
    #[arg(long, default_value_t = MAX_TICKS, requires = "files", value_parser = clap::value_parser!(u64).range(1..))]
    pub max_ticks: u64,
    /// How they are made.
    #[command(flatten)]
    pub work: WorkOptions,
    /// Folder for the results; it must be new or empty
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What the figures of a sweep are like.
    #[command(flatten)]
    pub figures: FigureOptions,
    /// Continue an interrupted ensemble in `--out`, or add runs to a finished one; without FILE all of it is as the
    /// folder says
    #[arg(long, requires = "out", conflicts_with = "run")]
    pub resume: bool,
    /// Continue it although another build of `stochc` has made its runs, if one of them comes out again as it was
    #[arg(long, requires = "resume", conflicts_with_all = ["shards", "run"])]
    pub mixed_builds: bool,
    /// Keep the states of runs under way in `--out` so often, for `--resume`: a time (90s, 5m, 2h), ticks of each run
    /// (20000ticks) or `never`. `rapier` runs have no checkpoints
    #[arg(long, value_name = "EVERY", default_value_t = Interval::DEFAULT, requires = "out", conflicts_with_all = ["shards", "run"])]
    pub checkpoints: Interval,
    /// Only prepare `--out`, cut into so many pieces: `stochc shard` makes each, anywhere, `stochc merge` puts them together
    #[arg(long, value_name = "M", requires = "out", conflicts_with_all = ["resume", "record", "run", "bonds", "format"])]
    pub shards: Option<u64>,
    /// Record the trajectories of these runs for `stochc replay`: 17, 0..4, 0,5,10..12 or all
    #[arg(long, value_name = "RUNS", requires = "out", conflicts_with = "run")]
    pub record: Option<Selection>,
    /// Record positions every so many ticks
    #[arg(long, value_name = "TICKS", default_value_t = EVERY, requires = "record", conflicts_with_all = ["shards", "run"], value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub record_every: u32,
    /// Simulate run N alone and print every event of it
    #[arg(long, value_name = "N", conflicts_with_all = ["runs", "out", "threads", "bonds"])]
    pub run: Option<u64>,
    /// Rewrite `report.html` in `--out` every few seconds while the runs are simulated; open it in a browser
    #[arg(long, requires = "out", conflicts_with_all = ["run", "shards"])]
    pub watch: bool,
    /// Print the expected CPU time of the runs, and make none of them
    #[arg(long, conflicts_with_all = ["run", "watch", "bonds"])]
    pub dry_run: bool,
    /// Output format of the table
    #[arg(long, value_name = "FORM", default_value = "text")]
    pub format: ResultsFormat,
    /// Also print every capture: waits, entries into the field, origin of the blocks
    #[arg(long)]
    pub bonds: bool,
    /// What becomes of warnings
    #[command(flatten)]
    pub levels: LevelOptions,
    /// Where imports may lie.
    #[command(flatten)]
    pub imports: ImportOptions,
}

/// One of the values of a setting, by its name.
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
