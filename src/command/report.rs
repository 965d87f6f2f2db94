//! `stochc report`.
use std::path::PathBuf;

use clap::Args;
use stochc_report::figures::Figures;

use super::figures::FigureOptions;
use super::host::Terminal;
use super::presentation::PresentationOptions;
use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::report::write;

/// What `report` is given.
#[derive(Debug, Args)]
#[command(mut_arg("figure_format", |it| it.visible_alias("format")))]
pub struct ReportArguments {
    /// Results folders of `simulate --out`; several are compared
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// File to write [default: `report.html` in DIR, or in the current folder for several]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
    /// What the figures beside the page are like.
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    presentation: PresentationOptions,
    /// Do not print the path of the report
    #[arg(long, short)]
    quiet: bool,
}

/// Writes a page on what folders hold, and its figures beside it.
pub fn run(options: &ReportArguments) -> Result<Exit, Failure> {
    let figures = Figures {
        presentation: options.presentation.presentation(),
        ..options.figures.figures()
    };
    let page = write(
        &options.folders,
        options.out.as_deref(),
        &figures,
        &Terminal::new(options.quiet),
    )?;
    if !options.quiet {
        print(&format!("{}\n", page.display()))?;
    }
    Ok(Exit::Success)
}
