//! `stochc calibrate`.
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use clap::Args;
use stochc_compiler::LintLevels;
use stochc_compiler::scene::built_in;
use stochc_ensemble::calibration::{Calibration, PROGRAMS, profile};
use stochc_ensemble::{Manifest, Program};
use stochc_files::atomic::{Replaces, replace};
use stochc_ir::scene::Scene;
use stochc_report::tables::rates_to_text;
use stochc_runtime::rates::Rates;
use stochc_runtime::world::rate::RateWorld;
use stochc_runtime::{Settings, Substeps};

use super::imports::ImportOptions;
use super::in_memory::all_runs;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::simulate::programs;
use super::terminal::{output_width, print};
use crate::exit::Exit;
use crate::exit::Failure;
use crate::facade::{check_texts, compile};

/// What `calibrate` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// A built-in scene, or a program: the scene that it runs in
    #[arg(value_name = "SCENE|FILE")]
    target: String,
    /// File for the rates; it must be new
    #[arg(long, value_name = "FILE.rates")]
    out: Option<PathBuf>,
    /// Runs of each of the programs that are observed
    #[arg(long, value_name = "N", default_value_t = RUNS, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    runs: u64,
    /// Steps of the model in each tick; `1/8`: one, and eight for blocks near magnetized faces
    #[arg(long, value_name = "STEPS", default_value_t = Substeps::DEFAULT)]
    substeps: Substeps,
    /// Stop a run after this many ticks; what it has captured until then counts
    #[arg(long, value_name = "TICKS", default_value_t = MAX_TICKS, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Seed of the random numbers
    #[arg(long, default_value_t = SEED, allow_negative_numbers = true)]
    seed: u64,
    /// Number of runs at the same time [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Do not show progress
    #[arg(long, short)]
    quiet: bool,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// What is simulated if nothing is said: some 15 s of processor time in the default scene.
const RUNS: u64 = 8;
const MAX_TICKS: u64 = 60_000;

/// Not that of `simulate`: the kicks of a calibration are never those of what it is held against.
const SEED: u64 = 0x5ca1_e000;

/// Measures the rates of a scene.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let scene = scene(options)?;
    let stop = stop_on_interrupt()?;
    let effort = Effort {
        settings: Settings {
            max_ticks: Some(options.max_ticks),
            ..Settings::default().with_steps(options.substeps)
        },
        runs: options.runs,
        seed: options.seed,
        threads: options.threads,
        quiet: options.quiet,
    };
    let rates = measure(&scene, &effort, stop)?;
    print(&rates_to_text(&rates, output_width()))?;
    if let Some(out) = &options.out {
        let text = rates.to_text();
        replace(out, text.as_bytes(), Replaces::Nothing).map_err(|error| {
            Failure::usage(format!("cannot write `{}`: {error}", out.display()))
        })?;
    }
    Ok(Exit::Success)
}

/// The scene that is named, or that a program runs in.
fn scene(options: &Options) -> Result<Scene, Failure> {
    if let Some(scene) = built_in(&options.target) {
        return Ok(scene);
    }
    let files = std::slice::from_ref(&options.target);
    let programs = programs(files, &options.levels.levels, &options.imports)?;
    let mut scenes = programs.into_iter().map(|program| program.scene);
    let first = scenes.next();
    let first =
        first.ok_or_else(|| Failure::usage(format!("`{}` has no program", options.target)))?;
    match scenes.any(|other| other != first) {
        true => Err(Failure::usage(format!(
            "the programs of `{}` run in several scenes; calibrate a file for each",
            options.target
        ))),
        false => Ok(first),
    }
}

/// How much is simulated.
#[derive(Clone, Debug)]
pub struct Effort {
    /// How.
    pub settings: Settings,
    /// Runs of each program.
    pub runs: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: Option<u16>,
    /// Whether to show no progress.
    pub quiet: bool,
}

impl Effort {
    /// As much as is usual.
    pub fn usual(threads: Option<u16>, quiet: bool) -> Effort {
        Effort {
            settings: Settings {
                max_ticks: Some(MAX_TICKS),
                ..Settings::default()
            },
            runs: RUNS,
            seed: SEED,
            threads,
            quiet,
        }
    }
}

/// Measures the rates of a scene by runs with physics.
pub fn measure(scene: &Scene, effort: &Effort, stop: &AtomicBool) -> Result<Rates, Failure> {
    if let Some(error) = RateWorld::refusal(scene) {
        return Err(Failure::wrong_program(error.to_string()));
    }
    let mut observed: Vec<Program> = Vec::new();
    for (name, text) in PROGRAMS {
        let checked = check_texts(&[(name, text)], &LintLevels::default(), "", &[]);
        let executables = compile(checked).map_err(|wrong| Failure::usage(wrong.to_string()))?;
        for mut executable in executables {
            // Blocks that are not there cannot be waited for.
            if executable.tables.captures() as u64 <= u64::from(scene.free.count) {
                executable.scene = scene.clone();
                observed.push(Program::new(name, Vec::new(), executable));
            }
        }
    }
    let gas = profile(scene, &effort.settings, effort.seed)
        .map_err(|error| Failure::wrong_program(error.to_string()))?;
    let manifest = Manifest::new(effort.settings.clone(), effort.seed, effort.runs, observed);
    let results = all_runs(
        &manifest,
        effort.threads,
        effort.quiet,
        stop,
        "nothing was calibrated",
    )?;
    let mut calibration = Calibration::new(scene, gas);
    for done in &results.finished {
        calibration.observe(&done.record);
    }
    calibration
        .rates(&effort.settings, effort.seed)
        .map_err(|error| Failure::error(Exit::UnsuccessfulRun, error.to_string()))
}
