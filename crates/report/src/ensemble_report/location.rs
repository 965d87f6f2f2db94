//! Place of a report, and its first line.
use std::time::Duration;

use crate::analysis::maps::RecordingReader;
use crate::figures::Figures;

/// First line of every report. It distinguishes reports from other files.
pub const MARK: &str = "<!DOCTYPE html><!-- stochc report -->";

/// Location of the report, and the resources that it refers to.
#[derive(Clone, Copy)]
pub struct ReportLocation<'a> {
    /// Name of the folder of figures and tables, next to the page.
    pub folder: &'a str,
    /// Formats of the figures.
    pub figures: &'a Figures,
    /// Interval of reloads by a browser. `None` if the page is not reloaded.
    pub reload: Option<Duration>,
    /// Returns the relative address of the replay of a run. Arguments: index of the folder, index
    /// of the program, number of the run. Returns `None` if there is no replay.
    pub replay: &'a dyn Fn(usize, usize, u64) -> Option<String>,
    /// Reader of the recordings.
    pub recordings: &'a RecordingReader<'a>,
}
