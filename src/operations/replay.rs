//! Replay page of a run.
use std::io::{self, Seek as _, Write};
use std::path::Path;

use stochc_compiler::LintLevels;
use stochc_files::atomic::{Draft, Replaces, begins_with};
use stochc_report::replay::{EventLocation, MARK, about, tour, write as write_page};
use stochc_results::EnsembleProgram;
use stochc_results::recording::Outline;
use stochc_text::visible;

use super::chosen_run::ChosenRun;
use super::stored_source::StoredSource;
use crate::exit::Failure;
use crate::host::Host;

/// Options for a replay page.
#[derive(Clone, Copy, Debug, Default)]
pub struct View<'a> {
    /// Another run of the same program that the page shows next to the first. `None` shows only one
    /// run.
    pub beside: Option<&'a ChosenRun>,
    /// Whether the page begins with the tour of the critical path.
    pub is_guided: bool,
}

/// Writes the replay page of a run, atomically.
///
/// # Errors
/// If the run has no recording and cannot be repeated, or the file cannot be written.
pub fn write(
    chosen: &ChosenRun,
    view: &View<'_>,
    path: &Path,
    host: &dyn Host,
) -> Result<(), Failure> {
    let cannot = |error| Failure::not_written(path, error);
    // Open the file first, so that errors appear before a long run.
    let ours = Replaces::Ours(|file| begins_with(file, MARK.as_bytes()));
    let mut out = Draft::new(path, ours).map_err(cannot)?;
    to(&mut out, chosen, view, host, cannot)?;
    out.keep().map_err(cannot)
}

/// Returns the replay page of a run.
///
/// # Errors
/// If the run has no recording and cannot be repeated.
pub fn page(chosen: &ChosenRun, view: &View<'_>, host: &dyn Host) -> Result<String, Failure> {
    let mut page = Vec::new();
    to(&mut page, chosen, view, host, Failure::usage)?;
    String::from_utf8(page).map_err(Failure::usage)
}

fn to(
    out: &mut impl Write,
    chosen: &ChosenRun,
    view: &View<'_>,
    host: &dyn Host,
    cannot: impl Fn(io::Error) -> Failure,
) -> Result<(), Failure> {
    let mut recording = chosen.recording(host)?;
    let beside = view.beside.map(|other| other.recording(host)).transpose()?;
    let program = chosen.entry();
    let outline = Outline::read(&mut recording, program.tables())
        .map_err(|error| cannot(io::Error::other(error)))?;
    recording.rewind().map_err(&cannot)?;
    let tour = tour(program, outline.record());
    let title = format!("{}, run {}", visible(&program.name), chosen.run);
    let statements = statements(program);
    let about = about(&chosen.manifest, program, &statements, tour, view.is_guided);
    write_page(&title, &about, recording, beside, out).map_err(cannot)
}

/// Largest number of events with source locations. Pages of larger programs do not highlight the
/// source.
const MAX_STATEMENTS: usize = 50_000;

/// Returns the source location of each event. Returns an empty list if the sources are missing or
/// compile to another program.
fn statements(program: &EnsembleProgram) -> Vec<EventLocation> {
    if program.sources.is_empty() || program.compiled.graph.events.len() > MAX_STATEMENTS {
        return Vec::new();
    }
    let text = StoredSource::new(program, &LintLevels::default());
    let Some(plan) = text.same_program().map(|program| &program.plan) else {
        return Vec::new();
    };
    let files: Vec<Option<usize>> = (text.checked.sources.files().iter())
        .map(|file| (program.sources.iter()).position(|source| source.path == file.name))
        .collect();
    let places = (0..).zip(&plan.events).filter_map(|(event, written)| {
        let span = written.location.span;
        Some(EventLocation {
            file: files[written.location.file.0 as usize]?,
            bytes: span.start as usize..span.end as usize,
            event,
        })
    });
    places.collect()
}
