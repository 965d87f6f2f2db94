//! Options that select one run of a results folder.
use std::path::PathBuf;

use clap::Args;

use super::host::Terminal;
use crate::exit::Failure;
use crate::host::Host as _;
use crate::operations::chosen_run::{self, ChosenRun, median_run};
use crate::operations::results::read;

/// Selection of a run.
#[derive(Clone, Debug, Args)]
pub struct RunSelection {
    /// Results folder of `simulate --out`
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Number of the run, counted from 0 [default: the run with the median completion time]
    #[arg(long, value_name = "N")]
    pub run: Option<u64>,
    /// Name of the program. Needed if the folder contains several programs
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
}

/// Returns the run that the options select. By default, this is the run with the median completion
/// time. In this case, a note names the run.
pub fn choose(choice: &RunSelection, host: &Terminal) -> Result<ChosenRun, Failure> {
    let (manifest, finished) = read(&choice.folder, host)?;
    let (folder, program) = (Some(choice.folder.as_path()), choice.program.as_deref());
    let run = match choice.run {
        Some(run) => run,
        None => {
            let run = median_run(&manifest, &finished, program)?;
            host.note(&format!(
                "note: run {run} has the median completion time. Choose another run with `--run N`\n"
            ));
            run
        }
    };
    chosen_run::choose(manifest, &finished, folder, program, run)
}
