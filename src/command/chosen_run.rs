//! One run of a folder of results.
use std::path::PathBuf;

use clap::Args;

use super::host::Terminal;
use crate::exit::Failure;
use crate::operations::chosen_run::{self, ChosenRun};
use crate::operations::results::read;

/// Which run.
#[derive(Clone, Debug, Args)]
pub struct RunSelection {
    /// Results folder of `simulate --out`
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Number of the run, from 0
    #[arg(long, value_name = "N")]
    pub run: u64,
    /// Name of the program; needed if the folder holds several
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
}

/// Finds a run.
pub fn choose(choice: &RunSelection, host: &Terminal) -> Result<ChosenRun, Failure> {
    let (manifest, finished) = read(&choice.folder, host)?;
    let (folder, program) = (Some(choice.folder.as_path()), choice.program.as_deref());
    chosen_run::choose((manifest, &finished), folder, program, choice.run)
}
