//! `stochc export`.
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use clap::{Args, ValueEnum};
use stochc_files::atomic::{Draft, Replaces, ends_with, holds};
use stochc_report::export::{GLTF_MARK, Gltf, TRAJECTORIES_MARK, Trajectories};

use super::chosen_run::{Choice, ChosenRun, choose};
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};

/// What `export` is given.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    choice: Choice,
    /// File format
    #[arg(long, value_name = "FORM")]
    format: Form,
    /// Export positions every so many ticks [default: 1 for parquet, 8 for gltf]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    every: Option<u32>,
    /// File to write [default: `DIR/PROGRAM-N.parquet` or `.glb`]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A form of trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// A table for DuckDB, Polars or pandas
    Parquet,
    /// An animation for Blender and other 3D programs
    Gltf,
}

/// Makes a run again and writes its trajectories.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let stop = stop_on_interrupt()?;
    let chosen = choose(&options.choice)?;
    let path = options.out.clone().unwrap_or_else(|| {
        let extension = match options.format {
            Form::Parquet => "parquet",
            Form::Gltf => "glb",
        };
        options
            .choice
            .folder
            .join(chosen.file_name("", &format!(".{extension}")))
    });
    match options.format {
        Form::Parquet => parquet(&chosen, options.every.unwrap_or(1), &path, stop)?,
        Form::Gltf => gltf(&chosen, options.every.unwrap_or(8), &path, stop)?,
    }
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}

fn parquet(chosen: &ChosenRun, every: u32, path: &Path, stop: &AtomicBool) -> Result<(), Failure> {
    let (tables, scene) = (chosen.entry().tables(), &chosen.entry().scene);
    let about = [
        ("ensemble", chosen.manifest.identity()),
        ("program", chosen.entry().name.clone()),
        ("run", chosen.run.to_string()),
        ("side_m", scene.block.side.to_string()),
        ("tick_s", scene.tick.to_string()),
    ];
    let file = Draft::new(
        path,
        Replaces::Ours(|file| ends_with(file, TRAJECTORIES_MARK)),
    )
    .map_err(|error| cannot(path, &error))?;
    let mut table =
        Trajectories::new(file, every, tables, &about).map_err(|error| cannot(path, &error))?;
    chosen.again(&mut table, stop)?;
    let file = table.finish().map_err(|error| cannot(path, &error))?;
    file.keep().map_err(|error| cannot(path, &error))
}

fn gltf(chosen: &ChosenRun, every: u32, path: &Path, stop: &AtomicBool) -> Result<(), Failure> {
    let (tables, scene) = (chosen.entry().tables(), &chosen.entry().scene);
    // Before the run, which may take long.
    let file = Draft::new(path, Replaces::Ours(|file| holds(file, GLTF_MARK)));
    let mut file = file.map_err(|error| cannot(path, &error))?;
    let mut gltf = Gltf::new(every, scene.free.count, tables);
    chosen.again(&mut gltf, stop)?;
    let title = format!("{}, run {}", tables.assembly, chosen.run);
    gltf.write(tables, scene, &title, &mut file)
        .map_err(|error| cannot(path, &error))?;
    file.keep().map_err(|error| cannot(path, &error))
}

fn cannot(path: &Path, error: &impl std::fmt::Display) -> Failure {
    Failure::usage(format!("cannot write `{}`: {error}", path.display()))
}
