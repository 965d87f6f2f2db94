//! `stochc export`.
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::chosen_run::{RunSelection, choose};
use super::host::Terminal;
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};
use crate::operations::export::{gltf, parquet};

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    #[command(flatten)]
    choice: RunSelection,
    /// File format [default: the format that fits the name of the file, `.parquet` or `.glb`]
    #[arg(long, value_name = "FORMAT", required_unless_present = "out")]
    format: Option<TrajectoryFormat>,
    /// Interval of the exported positions, in ticks [default: 1 for `parquet`, 8 for `gltf`]
    #[arg(long, value_name = "TICKS", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    every: Option<u32>,
    /// File to write [default: `DIR/PROGRAM-N.parquet` or `DIR/PROGRAM-N.glb`]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A file format of trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TrajectoryFormat {
    /// A table for DuckDB, Polars or pandas
    Parquet,
    /// An animation for Blender and other 3D programs
    Gltf,
}

impl TrajectoryFormat {
    fn extension(self) -> &'static str {
        match self {
            TrajectoryFormat::Parquet => "parquet",
            TrajectoryFormat::Gltf => "glb",
        }
    }

    fn name(self) -> &'static str {
        match self {
            TrajectoryFormat::Parquet => "parquet",
            TrajectoryFormat::Gltf => "gltf",
        }
    }
}

/// Returns the format that the option or the file extension states. Returns an error if they
/// differ.
fn format(
    given: Option<TrajectoryFormat>,
    out: Option<&Path>,
) -> Result<TrajectoryFormat, Failure> {
    let extension = out.and_then(Path::extension).and_then(OsStr::to_str);
    let formats = [TrajectoryFormat::Parquet, TrajectoryFormat::Gltf];
    let named = formats
        .into_iter()
        .find(|format| extension.is_some_and(|it| it.eq_ignore_ascii_case(format.extension())));
    match (given, named, out) {
        (Some(given), named, _) if named.is_none_or(|named| named == given) => Ok(given),
        (None, Some(named), _) => Ok(named),
        (Some(given), _, Some(out)) => Err(Failure::usage(format!(
            "`{}` does not end in `.{}`, the extension of `--format {}`",
            out.display(),
            given.extension(),
            given.name()
        ))),
        _ => Err(Failure::usage(
            "name the file `.parquet` or `.glb`, or choose the format with `--format parquet` or `--format gltf`",
        )),
    }
}

pub fn run(options: &ExportArguments) -> Result<Exit, Failure> {
    stop_on_interrupt()?;
    let host = Terminal::default();
    let format = format(options.format, options.out.as_deref())?;
    let chosen = choose(&options.choice, &host)?;
    let path = options.out.clone().unwrap_or_else(|| {
        let name = chosen.file_name("", &format!(".{}", format.extension()));
        options.choice.folder.join(name)
    });
    match format {
        TrajectoryFormat::Parquet => parquet(&chosen, options.every.unwrap_or(1), &path, &host)?,
        TrajectoryFormat::Gltf => gltf(&chosen, options.every.unwrap_or(8), &path, &host)?,
    }
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}
