//! `stochc report`.
use std::path::PathBuf;

use clap::Args;
use stochc_report::figures::Figures;

use super::figures::FigureOptions;
use super::host::Terminal;
use super::presentation::PresentationOptions;
use super::terminal::{is_quiet, print};
use crate::exit::{Exit, Failure};
use crate::operations::report::write;

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Results folders of `simulate --out`. The report compares the programs of all folders
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// File to write [default: `report.html` in DIR, or in the current folder if there are several folders]
    #[arg(long, short, value_name = "FILE.html")]
    out: Option<PathBuf>,
    /// Size and format of the figures.
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    presentation: PresentationOptions,
}

pub fn run(options: &ReportArguments) -> Result<Exit, Failure> {
    let figures = Figures {
        presentation: options.presentation.presentation(),
        ..options.figures.figures()
    };
    let page = write(
        &options.folders,
        options.out.as_deref(),
        &figures,
        &Terminal::default(),
    )?;
    if !is_quiet() {
        print(&format!("{}\n", page.display()))?;
    }
    Ok(Exit::Success)
}
