//! Analysis of an open program, in the client's terms.
use std::sync::{Arc, OnceLock};

use gen_lsp_types::{Location, Range};
use stochc_compiler::names::{Names, Occurrence};
use stochc_compiler::{
    Cancellation, Cancelled, Checked, FileId, Limits, Program, Reader, SourceLocation,
    check_cancellable,
};
use stochc_estimate::{Cost, Rates};

use super::documents::Documents;
use super::position::{Change, Encoding, LineIndex, line_starts};

/// Largest number of events for an estimate of times, to limit the response time.
const MAX_ESTIMATED: usize = 10_000;

/// A check takes long if all files together have this many bytes, or the programs this many events.
const LONG: usize = 1 << 14;

/// Analysis of an open program and its imported files.
#[derive(Clone, Debug)]
pub struct Analysis {
    pub checked: Arc<Checked>,
    pub names: Arc<Names>,
    encoding: Encoding,
    /// Starts of the lines of each file.
    lines: Arc<Vec<Vec<usize>>>,
    /// Estimated times of each program, computed on demand.
    costs: Arc<Vec<OnceLock<Option<Cost>>>>,
    /// Newer text of the program's own file, set on demand. `None` if the analysis is up to date.
    newer: Option<Arc<OnceLock<NewerText>>>,
    /// Whether imported files may have changed since the analysis.
    pub has_old_imports: bool,
}

/// Text of a file that was edited after its analysis.
#[derive(Debug)]
struct NewerText {
    text: String,
    lines: Vec<usize>,
    change: Change,
}

impl Analysis {
    /// Checks the program in a file.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if the check is cancelled.
    pub fn new(
        path: &str,
        reader: &mut dyn Reader,
        encoding: Encoding,
        cancellation: Cancellation<'_>,
    ) -> Result<Analysis, Cancelled> {
        let checked = check_cancellable(path, reader, Limits::EDITOR, cancellation)?;
        let names = Names::new(&checked, cancellation)?;
        let files = checked.sources.files().iter();
        let lines = files.map(|file| line_starts(&file.text)).collect();
        let costs = checked.programs.iter().map(|_| OnceLock::new()).collect();
        Ok(Analysis {
            checked: Arc::new(checked),
            names: Arc::new(names),
            encoding,
            lines: Arc::new(lines),
            costs: Arc::new(costs),
            newer: None,
            has_old_imports: false,
        })
    }

    /// Returns this analysis for a newer text of the program's own file or of an imported file. Bytes
    /// still count in the old text, and positions count in the new one.
    pub fn outdated(&self, is_own_text: bool) -> Analysis {
        Analysis {
            newer: Some(Arc::default()),
            has_old_imports: self.has_old_imports || !is_own_text,
            ..self.clone()
        }
    }

    /// Sets the newer text of an outdated analysis, if it is not set.
    pub fn set_newer(&self, text: impl FnOnce() -> String) {
        let Some(newer) = &self.newer else {
            return;
        };
        newer.get_or_init(|| {
            let (files, text) = (self.checked.sources.files(), text());
            NewerText {
                lines: line_starts(&text),
                change: Change::between(files.first().map_or("", |file| &file.text), &text),
                text,
            }
        });
    }

    /// Returns whether the text of a location in the program's own file is the same as at the
    /// analysis.
    pub fn is_unchanged(&self, location: SourceLocation) -> bool {
        let newer = self.newer.as_ref().and_then(|newer| newer.get());
        newer.is_none_or(|newer| location.file != FileId(0) || !newer.change.touches(location.span))
    }

    /// Returns whether a check of the program takes so long that requests should not wait for it.
    pub fn is_long(&self) -> bool {
        let bytes: usize = (self.checked.sources.files().iter())
            .map(|file| file.text.len())
            .sum();
        let events = (self.checked.programs.iter()).map(|program| program.plan.events.len());
        bytes.max(events.sum()) >= LONG
    }

    /// Returns the estimated times of a program, by number. Returns `None` for scenes without rates
    /// and for large programs.
    pub fn cost(&self, program: usize) -> Option<&Cost> {
        let cost = || times(&self.checked.programs[program]);
        self.costs.get(program)?.get_or_init(cost).as_ref()
    }

    pub fn path(&self, file: FileId) -> &str {
        &self.checked.sources.file(file).name
    }

    /// Returns the file with a path. Returns `None` if the file is not part of the program.
    pub fn file(&self, path: &str) -> Option<FileId> {
        let mut files = self.checked.sources.files().iter();
        let number = files.position(|file| file.name == path)?;
        Some(FileId(number as u32))
    }

    pub fn lines(&self, file: FileId) -> LineIndex<'_> {
        let newer = self.newer.as_ref().filter(|_| file == FileId(0));
        if let Some(newer) = newer.and_then(|newer| newer.get()) {
            let lines = LineIndex::known(&newer.text, newer.lines.as_slice(), self.encoding);
            return lines.changed(newer.change);
        }
        let text = &self.checked.sources.file(file).text;
        LineIndex::known(text, self.lines[file.0 as usize].as_slice(), self.encoding)
    }

    pub fn range(&self, location: SourceLocation) -> Range {
        self.lines(location.file).range(location.span)
    }

    /// Returns a location for the client.
    pub fn location(&self, location: SourceLocation, documents: &Documents) -> Location {
        Location {
            uri: documents.uri(self.path(location.file)).into(),
            range: self.range(location),
        }
    }

    /// Returns the name at a byte of the program's own file. Returns `None` if the byte is not part
    /// of a name, or if the name was edited after the analysis.
    pub fn name_at(&self, at: usize) -> Option<&Occurrence> {
        let name = self.names.at(FileId(0), at as u32);
        name.filter(|name| self.is_unchanged(name.location))
    }
}

fn times(program: &Program) -> Option<Cost> {
    let scene = program.scene.as_ref()?;
    let rates = Rates::known_or_guessed(&[], scene)?;
    let is_small = program.plan.events.len() <= MAX_ESTIMATED;
    is_small.then(|| program.estimate(Some(&*rates))).flatten()
}
