//! `stochc report`.
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use stochc_report::ensemble_report::{FigureFormat, Figures, Medium};

use super::memory::MemoryOption;
use super::terminal::{Terminal, print};
use crate::exit::{Exit, Failure};
use crate::operations::report::write;

/// What `report` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Results folders of `simulate --out`; several are compared
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// File to write [default: `report.html` in DIR, or in the current folder for several]
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
    /// Width of the figures beside the page in print, with 7 pt type: such as `89mm` or `183mm` (80 to 300) [default: as
    /// on the page]
    #[arg(long, value_name = "WIDTH")]
    figures: Option<Medium>,
    /// File format of the figures beside the page; several with commas between them
    #[arg(
        long,
        value_name = "FORM",
        value_delimiter = ',',
        default_value = "svg"
    )]
    format: Vec<FigureForm>,
    /// How much memory it may take.
    #[command(flatten)]
    memory: MemoryOption,
    /// Do not print the path of the report
    #[arg(long, short)]
    quiet: bool,
}

/// A form of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FigureForm {
    /// For browsers and drawing programs
    Svg,
    /// For papers, with the font in it
    Pdf,
}

/// Writes a page on what folders hold, and its figures beside it.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    options.memory.apply()?;
    let mut formats = Vec::new();
    for form in &options.format {
        let format = match form {
            FigureForm::Svg => FigureFormat::Svg,
            FigureForm::Pdf => FigureFormat::Pdf,
        };
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    let figures = Figures {
        medium: options.figures.unwrap_or_default(),
        formats,
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
