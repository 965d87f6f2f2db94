//! What came of ensembles, as one page to read and a folder of figures and tables.
//!
//! `analysis` sums up the inputs, [`figures`](crate::figures) and `data.rs` write that down, `page/` puts
//! the page together. All of it is a pure function of the inputs. `docs/guides/report.md` says what each figure shows.
mod data;
mod html;
pub(crate) mod narrative;
mod page;

use std::io::Write;
use std::time::Duration;

use stochc_experiments::trade::Trade;

use crate::analysis::maps::Maps;
use crate::analysis::reported_program::ReportedProgram;
use crate::analysis::{self, pairwise, reported_program, sweep, waits};
use crate::svg::Drawing;

pub use crate::analysis::maps::RecordingReader;
pub use crate::analysis::reported_program::{Input, ReportError};
pub use crate::figures::{FigureFormat, Figures};
pub use crate::svg::Medium;
pub use data::CHAINS;

/// The first line of every report, by which one is told from other people's files.
pub const MARK: &str = "<!DOCTYPE html><!-- stochc report -->";

/// A report, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The page, in HTML: complete in itself, and without any script.
    pub page: String,
    /// Figures and their data (CSV) but for [`CHAINS`], by the name of the file.
    pub files: Vec<(String, Vec<u8>)>,
    /// Whether [`CHAINS`] belongs to it: where nothing is captured, it would have no row.
    pub has_chains: bool,
}

/// What a report needs to know about the place that it is written to.
#[derive(Clone, Copy)]
pub struct ReportLocation<'a> {
    /// The name of the folder of figures and tables, which is beside the page.
    pub folder: &'a str,
    /// The figures in it.
    pub figures: &'a Figures,
    /// Time after which a browser reloads the page. `None` if it does not.
    pub reload: Option<Duration>,
    /// The address of the replay of a run as seen from the page, from the numbers of its folder, of
    /// its program in there, and its own; `None`: there is none.
    pub replay: &'a dyn Fn(usize, usize, u64) -> Option<String>,
    /// The recordings of runs.
    pub recordings: &'a RecordingReader<'a>,
}

/// Draws up the report of one or several results folders, and writes [`CHAINS`] meanwhile, which has rows for every run.
///
/// # Errors
/// Where runs cannot be read again, or `chains` cannot be written.
pub fn report(
    inputs: &[Input],
    surroundings: &ReportLocation,
    chains: &mut dyn Write,
) -> Result<Report, ReportError> {
    chains.write_all(data::chains_header().as_bytes())?;
    let shown = &surroundings.figures.presentation;
    let (mut subjects, mut sweeps) =
        reported_program::subjects(inputs, shown, &mut |subject, run| {
            chains.write_all(data::chains(subject, run).as_bytes())
        })?;
    let clock = shown.unit(subjects.iter().map(|subject| subject.program));
    let waits: Vec<_> = subjects.iter_mut().map(waits::waits).collect();
    let pairwise_tests = pairwise::pairwise_tests(&subjects, clock);
    sweeps.extend(sweep::found(&subjects, clock));
    let mut trades = Vec::new();
    for input in inputs {
        trades.extend(Trade::from_runs(&input.manifest, &input.finished)?);
    }
    let mut maps: Vec<Option<Maps>> = vec![None; subjects.len()];
    for (number, subject) in page::detailed(&subjects) {
        let input = &inputs[subject.folder];
        maps[number] = analysis::maps::maps(subject, input, surroundings.recordings)?;
    }
    let last = reported_program::last_seen(&subjects, clock);
    let tables = data::files(
        &subjects,
        &waits,
        &pairwise_tests,
        &sweeps,
        &maps,
        (clock, last),
    );
    let tables = tables.into_iter();
    let mut files: Vec<_> = tables
        .map(|(name, text)| (name, text.into_bytes()))
        .collect();
    let parts = page::Parts {
        inputs,
        subjects: &subjects,
        clock,
        last,
        waits: &waits,
        maps: &maps,
        pairwise_tests: &pairwise_tests,
        sweeps: &sweeps,
        trades: &trades,
        surroundings,
    };
    let mut drawings: Vec<Drawing> = Vec::new();
    let page = page::page(&parts, &mut drawings);
    for drawing in &drawings {
        files.extend(surroundings.figures.files(drawing)?);
    }
    files.sort();
    let has_chains = subjects.is_empty() || !subjects.iter().all(ReportedProgram::is_aggregate);
    Ok(Report {
        page,
        files,
        has_chains,
    })
}
