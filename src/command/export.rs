//! `stochc export`.
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::chosen_run::{RunSelection, choose};
use super::host::Terminal;
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};
use crate::operations::export::{gltf, parquet};

/// What `export` is given.
#[derive(Debug, Args)]
pub struct ExportArguments {
    #[command(flatten)]
    choice: RunSelection,
    /// File format
    #[arg(long, value_name = "FORM")]
    format: TrajectoryFormat,
    /// Export positions every so many ticks [default: 1 for parquet, 8 for gltf]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    every: Option<u32>,
    /// File to write [default: `DIR/PROGRAM-N.parquet` or `.glb`]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A form of trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TrajectoryFormat {
    /// A table for DuckDB, Polars or pandas
    Parquet,
    /// An animation for Blender and other 3D programs
    Gltf,
}

/// Makes a run again and writes its trajectories.
pub fn run(options: &ExportArguments) -> Result<Exit, Failure> {
    stop_on_interrupt()?;
    let host = Terminal::new(false);
    let chosen = choose(&options.choice, &host)?;
    let path = options.out.clone().unwrap_or_else(|| {
        let extension = match options.format {
            TrajectoryFormat::Parquet => "parquet",
            TrajectoryFormat::Gltf => "glb",
        };
        options
            .choice
            .folder
            .join(chosen.file_name("", &format!(".{extension}")))
    });
    match options.format {
        TrajectoryFormat::Parquet => parquet(&chosen, options.every.unwrap_or(1), &path, &host)?,
        TrajectoryFormat::Gltf => gltf(&chosen, options.every.unwrap_or(8), &path, &host)?,
    }
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}
