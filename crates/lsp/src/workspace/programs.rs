//! Open programs and the state of their analysis.
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use gen_lsp_types::Diagnostic as LspDiagnostic;
use stochc_compiler::{Cancellation, Reader};
use stochc_files::bound::{ImportFolders, identity};

use super::analysis::Analysis;
use super::documents::Documents;
use super::position::Encoding;
use super::reads::Reads;
use crate::features::diagnostics;
use crate::jobs::{JobId, JobTrigger, Jobs};

pub type DiagnosticsByFile = BTreeMap<String, Vec<LspDiagnostic>>;

pub struct CheckedProgram {
    analysis: Arc<Analysis>,
    found: DiagnosticsByFile,
}

/// Open programs by file path.
#[derive(Default)]
pub struct Programs(BTreeMap<String, OpenProgram>);

#[derive(Default)]
struct OpenProgram {
    state: AnalysisState,
    /// Files read by the last check.
    reads: Arc<Reads>,
    /// Whether the client has not received the current diagnostics yet.
    is_unseen: bool,
    /// Latest diagnostics of the program.
    found: DiagnosticsByFile,
    /// Last analysis, if the texts have changed since and a check takes long.
    last: Option<Arc<Analysis>>,
    /// Whether the client has received responses, or may show diagnostics, that the next check can
    /// change although the text stays the same.
    is_refresh_due: bool,
}

/// State of the analysis of a program's current texts.
#[derive(Default)]
enum AnalysisState {
    #[default]
    Unknown,
    Running(JobId),
    Known(Arc<Analysis>),
    /// The check has panicked.
    Failed,
}

/// State of the analysis of a program's current texts.
pub enum Knowledge {
    /// The analysis is up to date.
    Known(Arc<Analysis>),
    /// The check has not started or not ended yet.
    Waiting,
    Failed,
}

impl Programs {
    pub fn paths(&self) -> impl Iterator<Item = &String> {
        self.0.keys()
    }

    /// Records that a text was opened or changed. Returns the programs whose analysis is now out of
    /// date.
    pub fn changed<T>(&mut self, path: &str, jobs: &Jobs<T>) -> BTreeSet<String> {
        self.0.entry(path.to_owned()).or_default();
        self.outdate(path, jobs, |own, reads| {
            own == path || reads.lack_a_file() || reads.include(path)
        })
    }

    /// Compares all files that are not open with the disk. Returns the programs that have to be
    /// checked again.
    pub fn changed_on_disk<T>(
        &mut self,
        documents: &Documents,
        encoding: Encoding,
        jobs: &Jobs<T>,
    ) -> BTreeSet<String> {
        self.outdate("", jobs, |_, reads| reads.are_outdated(documents, encoding))
    }

    /// Removes a closed program, and records that the file on disk replaces its text. Returns the
    /// programs whose analysis is now out of date.
    pub fn closed<T>(&mut self, path: &str, jobs: &Jobs<T>) -> BTreeSet<String> {
        let mut outdated = self.changed(path, jobs);
        self.0.remove(path);
        outdated.insert(path.to_owned());
        outdated
    }

    /// Invalidates the analyses of some programs after a change of a file, and cancels their
    /// checks.
    fn outdate<T>(
        &mut self,
        changed: &str,
        jobs: &Jobs<T>,
        is_outdated: impl Fn(&str, &Reads) -> bool,
    ) -> BTreeSet<String> {
        let mut outdated = BTreeSet::new();
        for (path, program) in &mut self.0 {
            // A check records a file before reading it, and the text changed before this call.
            // Unrecorded files will therefore be read in their new state.
            if !is_outdated(path, &program.reads) {
                continue;
            }
            if let AnalysisState::Running(job) = program.state {
                jobs.cancel(job);
            }
            let last = match std::mem::take(&mut program.state) {
                AnalysisState::Known(analysis) => Some(analysis).filter(|it| it.is_long()),
                _ => program.last.take(),
            };
            program.last = last.map(|last| Arc::new(last.outdated(path == changed)));
            program.is_unseen = true;
            program.is_refresh_due |= path != changed;
            outdated.insert(path.clone());
        }
        outdated
    }

    /// Returns whether the analysis of a program's current texts is available. Returns `None` if
    /// the program is not open.
    pub fn known(&self, path: &str) -> Option<Knowledge> {
        Some(match &self.0.get(path)?.state {
            AnalysisState::Known(analysis) => Knowledge::Known(analysis.clone()),
            AnalysisState::Unknown | AnalysisState::Running(_) => Knowledge::Waiting,
            AnalysisState::Failed => Knowledge::Failed,
        })
    }

    /// Returns an analysis of earlier texts, if the check takes long. The client must refresh the
    /// response after the check.
    pub fn last(&mut self, path: &str) -> Option<Arc<Analysis>> {
        let program = self.0.get_mut(path)?;
        let last = program.last.clone()?;
        program.is_refresh_due = true;
        Some(last)
    }

    /// Returns the diagnostics that a program has found in its own file.
    pub fn own(&self, path: &str) -> &[LspDiagnostic] {
        let found = self.0.get(path).and_then(|it| it.found.get(path));
        found.map_or(&[], Vec::as_slice)
    }

    /// Returns whether the diagnostics of a file are not yet determined.
    pub fn is_unseen(&self, path: &str) -> bool {
        self.0.get(path).is_some_and(|program| program.is_unseen)
    }

    /// Returns the diagnostics of all programs by file path.
    pub fn found(&self) -> impl Iterator<Item = (&String, &Vec<LspDiagnostic>)> {
        self.0.values().flat_map(|program| &program.found)
    }

    /// Returns a changed program that is waiting for its check. Returns `None` if there is none.
    pub fn unchecked(&self) -> Option<&String> {
        let is_unchecked = |program: &OpenProgram| {
            program.is_unseen && matches!(program.state, AnalysisState::Unknown)
        };
        let unchecked = self.0.iter().find(|(_, program)| is_unchecked(program));
        unchecked.map(|(path, _)| path)
    }

    /// Starts the check of a program without an analysis, if another job is allowed.
    pub fn check<T: From<CheckedProgram> + 'static>(
        &mut self,
        path: &str,
        trigger: JobTrigger,
        documents: &Documents,
        folders: &Arc<[PathBuf]>,
        encoding: Encoding,
        jobs: &mut Jobs<T>,
    ) {
        let Some(program) = self.0.get_mut(path) else {
            return;
        };
        if !matches!(program.state, AnalysisState::Unknown) || !jobs.has_room(trigger) {
            return;
        }
        program.reads = Arc::default();
        let (path, documents, reads) = (path.to_owned(), documents.clone(), program.reads.clone());
        let folders = folders.clone();
        let job = jobs.start(move |cancellation| {
            check(&path, &documents, &reads, &folders, encoding, cancellation).map(T::from)
        });
        program.state = job.map_or(AnalysisState::Failed, AnalysisState::Running);
    }

    /// Stores the result of a check, and returns whether the client must refresh earlier responses.
    /// Returns `None` if the check is out of date.
    pub fn checked(&mut self, job: JobId, checked: Option<CheckedProgram>) -> Option<bool> {
        let is_it = |program: &&mut OpenProgram| matches!(program.state, AnalysisState::Running(own) if own == job);
        let program = self.0.values_mut().find(is_it)?;
        program.last = None;
        program.is_unseen = false;
        program.state = match checked {
            Some(checked) => {
                program.found = checked.found;
                AnalysisState::Known(checked.analysis)
            }
            None => AnalysisState::Failed,
        };
        Some(std::mem::take(&mut program.is_refresh_due))
    }
}

/// Reader that records the files of a program.
struct ProgramReader<'a> {
    documents: &'a Documents,
    encoding: Encoding,
    reads: &'a Reads,
    bound: ImportFolders,
}

impl Reader for ProgramReader<'_> {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        self.reads.read(path, self.documents, self.encoding)
    }

    fn identity(&mut self, path: &str) -> Option<String> {
        identity(path)
    }

    fn outside(&mut self, path: &str) -> Option<String> {
        self.bound.outside(path)
    }
}

/// Checks a program that may import from these folders, and records its files. Returns `None` if
/// the check was cancelled.
fn check(
    path: &str,
    documents: &Documents,
    reads: &Reads,
    folders: &[PathBuf],
    encoding: Encoding,
    cancellation: Cancellation<'_>,
) -> Option<CheckedProgram> {
    let bound = ImportFolders::new(path, folders);
    let mut reader = ProgramReader {
        documents,
        encoding,
        reads,
        bound,
    };
    let analysis = Analysis::new(path, &mut reader, encoding, cancellation).ok()?;
    Some(CheckedProgram {
        found: diagnostics::of(&analysis, path, documents),
        analysis: Arc::new(analysis),
    })
}
