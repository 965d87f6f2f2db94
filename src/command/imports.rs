//! The option `--allow-import`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_files::bound::folder;

/// Further folders for imports.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Warnings and imports")]
pub struct ImportOptions {
    /// Allow imports from this folder, in addition to the folder of the program
    #[arg(long = "allow-import", value_name = "DIR", value_parser = resolved)]
    pub folders: Vec<PathBuf>,
}

fn resolved(path: &str) -> Result<PathBuf, String> {
    folder(Path::new(path)).map_err(|error| error.to_string())
}
