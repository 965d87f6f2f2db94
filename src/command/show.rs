//! `stochc show`, and printing of results for `simulate`.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use stochc_report::presentation::Presentation;
use stochc_results::{Contents, Manifest, Records, write_tables};
use stochc_text::Markup;
use stochc_text::counted;

use super::host::Terminal;
use super::narrative::show_runs;
use super::presentation::PresentationOptions;
use super::run_options::ResultsOptions;
use super::terminal::{argument, output_width, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::results::{ensemble_results, read_contents};

/// Arguments of `show`.
#[derive(Debug, Args)]
pub struct ShowArguments {
    /// Results folder
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Further folders, which only `report` compares
    #[arg(value_name = "DIR", hide = true)]
    others: Vec<PathBuf>,
    /// Print the events of run N of each program, instead of the results of all runs
    #[arg(long, value_name = "N", conflicts_with_all = ["captures", "tables"])]
    run: Option<u64>,
    /// Format of the output
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "text",
        conflicts_with = "json"
    )]
    format: TableFormat,
    #[command(flatten)]
    presentation: PresentationOptions,
    /// Also write Parquet tables of the finished runs into this folder
    #[arg(long, value_name = "FOLDER")]
    tables: Option<PathBuf>,
    #[command(flatten)]
    shown: ResultsOptions,
}

/// Output format of the tables of a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TableFormat {
    /// A table for the terminal
    Text,
    /// JSON
    Json,
    /// Comma-separated values with a row for each program
    Csv,
    /// A LaTeX table for the package `booktabs`
    Latex,
    /// A Markdown table
    Markdown,
}

/// Options for printing the results of an ensemble.
#[derive(Clone, Copy, Debug)]
pub struct ResultsView<'a> {
    pub form: TableFormat,
    /// Unit of times, and names of programs.
    pub how: &'a Presentation,
    /// Number of captures to list for each program, longest waiting times first. `None` lists no
    /// captures.
    pub captures: Option<usize>,
    /// Results folder. `None` if the results are not stored.
    pub folder: Option<&'a Path>,
}

impl ShowArguments {
    fn format(&self) -> TableFormat {
        if self.shown.output.json {
            TableFormat::Json
        } else {
            self.format
        }
    }

    /// Returns an error if an option does not apply to the chosen output format.
    fn are_consistent(&self) -> Result<(), Failure> {
        if !self.others.is_empty() {
            let folders = std::iter::once(&self.folder).chain(&self.others);
            let folders: Vec<String> = folders.map(|folder| argument(folder)).collect();
            return Err(Failure::usage(format!(
                "`show` prints one results folder; `stochc report {}` compares several",
                folders.join(" ")
            )));
        }
        let is_published = !matches!(self.format(), TableFormat::Text | TableFormat::Json);
        if self.presentation.presentation().in_seconds && self.format() == TableFormat::Json {
            return Err(Failure::usage(
                "`--unit s` is not for JSON, which has times in ticks and the length of a tick",
            ));
        }
        if self.shown.captures.is_some() && is_published {
            return Err(Failure::usage(
                "`--captures` is for `--format text` and `json`; `bonds.parquet` has every capture as a table",
            ));
        }
        Ok(())
    }
}

/// Prints the results of a folder. The exit status shows whether files are corrupted or runs are
/// missing.
pub fn run(options: &ShowArguments) -> Result<Exit, Failure> {
    options.are_consistent()?;
    let host = Terminal::default();
    let Contents {
        manifest,
        finished,
        damage,
    } = read_contents(&options.folder, &host)?;
    let missing = manifest.total().saturating_sub(finished.len() as u64);
    if let Some(run) = options.run {
        return show_run(
            &manifest,
            &finished,
            run,
            options.format() == TableFormat::Json,
        );
    }
    if missing > 0 {
        warn(&format!(
            "{missing} of {} {} still to do\n",
            counted(manifest.total() as usize, "run"),
            if missing == 1 { "is" } else { "are" }
        ));
    }
    let mut how = options.presentation.presentation();
    // Text has both units.
    how.in_seconds &= options.format() != TableFormat::Text;
    let shown = ResultsView {
        form: options.format(),
        how: &how,
        captures: options.shown.captures,
        folder: Some(&options.folder),
    };
    let exit = show(&manifest, &finished, &shown)?;
    if let Some(folder) = &options.tables {
        write_tables(folder, &manifest, &finished).map_err(Failure::usage)?;
    }
    if !damage.is_empty() {
        return Ok(Exit::Usage);
    }
    Ok(exit.or_worse(Exit::from_runs(missing == 0)))
}

/// Prints the events of run number `run` of each program. Returns [`Exit::UnsuccessfulRun`] if one
/// of these runs did not complete.
fn show_run(
    manifest: &Manifest,
    finished: &Records,
    run: u64,
    is_json: bool,
) -> Result<Exit, Failure> {
    let mut records = Vec::new();
    for (number, program) in manifest.programs.iter().enumerate() {
        if let Some(done) = finished.get(number, run).map_err(Failure::usage)? {
            records.push((done.record, program));
        }
    }
    if records.is_empty() {
        return Err(Failure::usage(manifest.no_such_run(run)));
    }
    show_runs(&records, is_json)
}

/// Prints the comparison of an ensemble's programs. Returns [`Exit::UnsuccessfulRun`] if one of the
/// runs did not complete.
pub fn show(
    manifest: &Manifest,
    finished: &Records,
    shown: &ResultsView<'_>,
) -> Result<Exit, Failure> {
    let results = ensemble_results(manifest, finished, shown.captures)?.shown(shown.how)?;
    let failure = results.failure(shown.folder);
    let exit = Exit::from_runs(results.are_all_successful());
    print(&match shown.form {
        TableFormat::Text => results.text(output_width()),
        TableFormat::Json => results.json(),
        TableFormat::Csv => results.csv(),
        TableFormat::Latex => results.markup(Markup::Latex),
        TableFormat::Markdown => results.markup(Markup::Markdown),
    })?;
    failure.iter().for_each(|failure| warn(failure));
    Ok(exit)
}
