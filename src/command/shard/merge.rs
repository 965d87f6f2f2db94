//! `stochc shard merge`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_files::shell::file as shell_file;
use stochc_text::visible;

use super::super::terminal::{is_quiet, print};
use crate::exit::{Exit, Failure};
use crate::operations::shard::merge;

/// Arguments of `shard merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Folder of `stochc shard new`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

pub fn run(options: &MergeArguments) -> Result<Exit, Failure> {
    let runs = merge(&options.folder)?;
    if !is_quiet() {
        print(&merged(&options.folder, runs))?;
    }
    Ok(Exit::Success)
}

/// Returns the message about a folder whose shards are already merged.
pub(super) fn merged(folder: &Path, runs: u64) -> String {
    let folder = visible(&folder.to_string_lossy());
    let argument = shell_file(&folder);
    format!("`{folder}` is complete: {runs} runs. Next: stochc show {argument}\n")
}
