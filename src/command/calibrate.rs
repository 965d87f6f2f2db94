//! `stochc calibrate`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_compiler::scene::{built_in, built_in_names};
use stochc_files::atomic::Replaces;
use stochc_ir::scene::Scene;
use stochc_report::tables::rates_to_text;
use stochc_runtime::{Settings, Substeps};
use stochc_text::visible;

use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::new_file::NewFile;
use super::run_options::ThreadsOption;
use super::source_options::SourceOptions;
use super::terminal::{argument, close, output_width, print};
use crate::exit::{Exit, Failure};
use crate::operations::calibration::{Effort, MAX_TICKS, SEED, measure};
use crate::operations::programs::programs;

/// Arguments of `calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// Name of a built-in scene, or a program whose scene is calibrated
    #[arg(value_name = "SCENE|FILE")]
    target: String,
    /// File for the rates. It must not exist yet
    #[arg(long, short, value_name = "FILE.rates")]
    out: Option<PathBuf>,
    /// Number of runs of each calibration program. By default 6, or as many as a held-out error
    /// needs
    #[arg(long, short = 'n', value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    runs: Option<u64>,
    /// Time steps per tick. `2/8` means eight steps for blocks near open faces, and two for all other blocks
    #[arg(long, value_name = "STEPS", default_value_t = Substeps::DEFAULT)]
    substeps: Substeps,
    /// Stop each run after this many ticks. The captures before this time are used
    #[arg(long, value_name = "TICKS", default_value_t = MAX_TICKS, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Seed of the random numbers. The same seed gives the same runs
    #[arg(long, value_name = "N", default_value_t = SEED)]
    seed: u64,
    #[command(flatten)]
    work: ThreadsOption,
    #[command(flatten)]
    source: SourceOptions,
}

pub fn run(options: &CalibrateArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let out = options.out.as_deref();
    let out = out.map(|path| NewFile::begin(path, Replaces::Nothing));
    let out = out.transpose()?;
    let scene = scene(options, &host)?;
    stop_on_interrupt()?;
    let effort = Effort {
        settings: Settings {
            max_ticks: Some(options.max_ticks),
            ..Settings::default().with_steps(options.substeps)
        },
        runs: options.runs,
        seed: options.seed,
        threads: options.work.threads,
    };
    let rates = measure(&scene, &effort, &host)?;
    print(&rates_to_text(&rates, output_width()))?;
    if let Some(out) = out {
        out.write(&rates.to_text())?;
        let file = options.out.as_deref().map(argument).unwrap_or_default();
        let next = match rates.check_accuracy() {
            Ok(()) => format!("Next: stochc estimate FILE --rates {file}"),
            Err(_) => "Commands refuse it".to_owned(),
        };
        close(&format!("Saved in {file}. {next}\n"));
    }
    match rates.check_accuracy() {
        Ok(()) => Ok(Exit::Success),
        Err(error) => Err(Failure::error(Exit::UnsuccessfulRun, error)),
    }
}

/// Returns the scene with the requested name, or the only scene of a program.
fn scene(options: &CalibrateArguments, host: &Terminal) -> Result<Scene, Failure> {
    if let Some(scene) = built_in(&options.target) {
        return Ok(scene);
    }
    if !Path::new(&options.target).exists() {
        return Err(Failure::usage(format!(
            "no file and no built-in scene is called `{}`; built-in scenes: {}",
            visible(&options.target),
            built_in_names()
        )));
    }
    let files = std::slice::from_ref(&options.target);
    let source = options.source.settings();
    let programs = programs(files, &source, host)?;
    let mut scenes = programs.into_iter().map(|program| program.scene);
    let first = scenes.next();
    let first =
        first.ok_or_else(|| Failure::usage(format!("`{}` has no program", options.target)))?;
    if scenes.any(|other| other != first) {
        Err(Failure::usage(format!(
            "the programs of `{}` run in several scenes; calibrate a file for each",
            options.target
        )))
    } else {
        Ok(first)
    }
}
