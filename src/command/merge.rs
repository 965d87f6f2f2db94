//! `stochc merge`.
use std::path::PathBuf;

use clap::Args;
use stochc_ensemble::text::visible;
use stochc_files::shell::file as shell_file;

use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::shard::merge;

/// What `merge` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Folder of `simulate --shards`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Do not say that it is done
    #[arg(long, short)]
    quiet: bool,
}

/// Puts the pieces of an ensemble together.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let runs = merge(&options.folder)?;
    if !options.quiet {
        let folder = visible(&options.folder.to_string_lossy());
        print(&format!(
            "`{folder}` is whole: {runs} runs; stochc results {}\n",
            shell_file(&folder)
        ))?;
    }
    Ok(Exit::Success)
}
