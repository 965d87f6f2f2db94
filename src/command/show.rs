//! `stochc show`, and the table that `simulate` ends with.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use stochc_ensemble::{Contents, Manifest, Records, write_tables};
use stochc_ir::counted;
use stochc_report::presentation::Presentation;
use stochc_report::text::Markup;

use super::host::Terminal;
use super::presentation::PresentationOptions;
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
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    format: TableFormat,
    #[command(flatten)]
    presentation: PresentationOptions,
    /// Also write the Parquet tables of the finished runs into this folder
    #[arg(long, value_name = "FOLDER")]
    tables: Option<PathBuf>,
    /// Also print every capture: waits, entries into the field, origin of the blocks
    #[arg(long)]
    bonds: bool,
}

/// A form of the table of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ResultsFormat {
    /// Table for the terminal
    Text,
    /// JSON
    Json,
}

/// Output format of the tables of a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TableFormat {
    /// Table for the terminal
    Text,
    /// JSON
    Json,
    /// Comma-separated values, a row for each program
    Csv,
    /// LaTeX table for the package `booktabs`
    Latex,
    /// Markdown table
    Markdown,
}

impl From<ResultsFormat> for TableFormat {
    fn from(format: ResultsFormat) -> TableFormat {
        match format {
            ResultsFormat::Text => TableFormat::Text,
            ResultsFormat::Json => TableFormat::Json,
        }
    }
}

/// What to show of an ensemble.
#[derive(Clone, Copy, Debug)]
pub struct ResultsView<'a> {
    /// In which form.
    pub form: TableFormat,
    /// Unit of times and names of programs.
    pub how: &'a Presentation,
    /// The captures as well.
    pub bonds: bool,
    /// Where its runs are kept; `None`: nowhere.
    pub folder: Option<&'a Path>,
}

impl ShowArguments {
    /// Refuses options that the format does not use.
    fn are_consistent(&self) -> Result<(), Failure> {
        let is_published = !matches!(self.format, TableFormat::Text | TableFormat::Json);
        if self.presentation.presentation().in_seconds && !is_published {
            return Err(Failure::usage(
                "`--unit s` is for `--format csv`, `latex` and `markdown`; text has both units, JSON the length of a tick",
            ));
        }
        if self.bonds && is_published {
            return Err(Failure::usage(
                "`--bonds` is for `--format text` and `json`; `bonds.parquet` has every capture as a table",
            ));
        }
        Ok(())
    }
}

/// Shows what a folder holds. Corrupted files and missing runs have an exit status of their own.
pub fn run(options: &ShowArguments) -> Result<Exit, Failure> {
    options.are_consistent()?;
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
    let how = options.presentation.presentation();
    let shown = ResultsView {
        form: options.format,
        how: &how,
        bonds: options.bonds,
        folder: Some(&options.folder),
    };
    let exit = show(&manifest, &finished, &shown)?;
    if let Some(folder) = &options.tables {
        write_tables(folder, &manifest, &finished).map_err(Failure::usage)?;
    }
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
    let told = ensemble_results(manifest, finished, shown.bonds)?.shown(shown.how)?;
    let failure = told.failure(shown.folder);
    let exit = Exit::of_runs(told.are_all_successful());
    print(&match shown.form {
        TableFormat::Text => told.text(output_width()),
        TableFormat::Json => told.json(),
        TableFormat::Csv => told.csv(),
        TableFormat::Latex => told.markup(Markup::Latex),
        TableFormat::Markdown => told.markup(Markup::Markdown),
    })?;
    failure.iter().for_each(|failure| warn(failure));
    Ok(exit)
}
