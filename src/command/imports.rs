//! `--allow-import`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_files::bound::folder;

/// Where imports may lie.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Warnings and imports")]
pub struct ImportOptions {
    /// Let programs import files of this folder too
    #[arg(long = "allow-import", value_name = "DIR", value_parser = resolved)]
    pub folders: Vec<PathBuf>,
}

fn resolved(path: &str) -> Result<PathBuf, String> {
    folder(Path::new(path)).map_err(|error| error.to_string())
}
