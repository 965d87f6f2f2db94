//! `stochc merge`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_ensemble::text::visible;
use stochc_files::shell::file as shell_file;

use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::shard::merge;

/// What `merge` is given.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Folder of `simulate --shards`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Do not say that it is done
    #[arg(long, short)]
    quiet: bool,
}

/// Puts the pieces of an ensemble together.
pub fn run(options: &MergeArguments) -> Result<Exit, Failure> {
    let runs = merge(&options.folder)?;
    if !options.quiet {
        print(&is_whole(&options.folder, runs))?;
    }
    Ok(Exit::Success)
}

/// What there is to say of a folder of so many runs whose pieces are put together.
pub(super) fn is_whole(folder: &Path, runs: u64) -> String {
    let folder = visible(&folder.to_string_lossy());
    let argument = shell_file(&folder);
    format!("`{folder}` is whole: {runs} runs; stochc show {argument}\n")
}
