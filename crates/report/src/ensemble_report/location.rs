//! Location of a report, and the first line of its page.
use std::time::Duration;

use crate::analysis::maps::RecordingReader;
use crate::figures::Figures;

/// First line of every report. Other files do not begin with it.
pub const MARK: &str = "<!DOCTYPE html><!-- stochc report -->";

/// Location of a report, and the resources that the report refers to.
#[derive(Clone, Copy)]
pub struct ReportLocation<'a> {
    /// Name of the folder for figures and tables, next to the page.
    pub folder: &'a str,
    /// Size and file formats of the figures.
    pub figures: &'a Figures,
    /// Time between reloads of the page by a browser. `None` if the page is not reloaded.
    pub reload: Option<Duration>,
    /// Function that returns the relative address of the replay of a run. Returns `None` if there
    /// is no replay. Its arguments are the index of the folder, the index of the program, and the
    /// number of the run.
    pub replay: &'a dyn Fn(usize, usize, u64) -> Option<String>,
    /// Function that opens recordings.
    pub recordings: &'a RecordingReader<'a>,
}
