//! Complete report on ensembles.
use std::io::Write;

use stochc_experiments::trade::Trade;

use super::location::ReportLocation;
use super::{data, page};
use crate::analysis;
use crate::analysis::maps::Maps;
use crate::analysis::reported_program::{Input, ReportError, ReportedProgram};
use crate::analysis::{pairwise, reported_program, sweep, waits};
use crate::svg::Drawing;

/// Complete report with its figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// HTML of the page. It is self-contained and without scripts.
    pub page: String,
    /// Name and content of each file: figures and their data (CSV), except
    /// [`CRITICAL_PATHS`](super::CRITICAL_PATHS).
    pub files: Vec<(String, Vec<u8>)>,
    /// Whether the report includes [`CRITICAL_PATHS`](super::CRITICAL_PATHS). Without captures, this table would
    /// have no rows.
    pub has_critical_paths: bool,
}

/// Creates the report of one or several results folders. Writes [`CRITICAL_PATHS`](super::CRITICAL_PATHS) directly
/// to `critical_paths`, because this table has rows for every run.
///
/// # Errors
///
/// If runs cannot be read again, or `critical_paths` cannot be written.
pub fn report(
    inputs: &[Input],
    surroundings: &ReportLocation,
    critical_paths: &mut dyn Write,
) -> Result<Report, ReportError> {
    critical_paths.write_all(data::critical_paths_header().as_bytes())?;
    let shown = &surroundings.figures.presentation;
    let (mut subjects, mut sweeps) =
        reported_program::subjects(inputs, shown, &mut |subject, run| {
            critical_paths.write_all(data::critical_paths(subject, run).as_bytes())
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
        clock,
        last,
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
    let has_critical_paths =
        subjects.is_empty() || !subjects.iter().all(ReportedProgram::is_aggregate);
    Ok(Report {
        page,
        files,
        has_critical_paths,
    })
}
