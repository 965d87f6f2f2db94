//! `stochc show`, and the table that `simulate` ends with.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use stochc_ensemble::{Contents, Manifest, Records};
use stochc_ir::counted;

use super::host::Terminal;
use super::memory::MemoryOption;
use super::terminal::{output_width, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::results::{ensemble_results, read_contents};

/// What `show` is given.
#[derive(Debug, Args)]
pub struct ShowArguments {
    /// Results folder of `simulate --out`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Output format of the table
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: ResultsFormat,
    /// Also print every capture: waits, entries into the field, origin of the blocks
    #[arg(long)]
    bonds: bool,
    /// How much memory it may take.
    #[command(flatten)]
    memory: MemoryOption,
}

/// A form of the table of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResultsFormat {
    /// For people
    Text,
    /// For programs
    Json,
}

/// What to show of an ensemble.
#[derive(Clone, Copy, Debug)]
pub struct ResultsView<'a> {
    /// In which form.
    pub form: ResultsFormat,
    /// The captures as well.
    pub bonds: bool,
    /// Where its runs are kept; `None`: nowhere.
    pub folder: Option<&'a Path>,
}

/// Shows what a folder holds. Corrupted files and missing runs have an exit status of their own.
pub fn run(options: &ShowArguments) -> Result<Exit, Failure> {
    options.memory.apply()?;
    let Contents {
        manifest,
        finished,
        damage,
    } = read_contents(&options.folder, &Terminal::new(false))?;
    let missing = manifest.total().saturating_sub(finished.len() as u64);
    if missing > 0 {
        warn(&format!(
            "{missing} of {} {} still to do\n",
            counted(manifest.total() as usize, "run"),
            if missing == 1 { "is" } else { "are" }
        ));
    }
    let shown = ResultsView {
        form: options.format,
        bonds: options.bonds,
        folder: Some(&options.folder),
    };
    let exit = show(&manifest, &finished, &shown)?;
    if !damage.is_empty() {
        return Ok(Exit::Usage);
    }
    Ok(exit.or_worse(Exit::of_runs(missing == 0)))
}

/// Prints the comparison of an ensemble's programs; says whether every run was successful.
pub fn show(
    manifest: &Manifest,
    finished: &Records,
    shown: &ResultsView<'_>,
) -> Result<Exit, Failure> {
    let told = ensemble_results(manifest, finished, shown.bonds)?;
    let failure = told.failure(shown.folder);
    let exit = Exit::of_runs(told.are_all_successful());
    print(&match shown.form {
        ResultsFormat::Text => told.text(output_width()),
        ResultsFormat::Json => told.json(),
    })?;
    failure.iter().for_each(|failure| warn(failure));
    Ok(exit)
}
