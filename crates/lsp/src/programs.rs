//! What is known of each open program, and what is being found out.
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use gen_lsp_types::Diagnostic as LspDiagnostic;
use stochc_compiler::{Cancellation, Reader};
use stochc_files::bound::{ImportFolders, identity};

use super::analysis::Analysis;
use super::diagnostics;
use super::documents::Documents;
use super::jobs::{JobId, JobTrigger, Jobs};
use super::position::Encoding;
use super::reads::Reads;

/// Diagnostics by the path of their file.
pub type DiagnosticsByFile = BTreeMap<String, Vec<LspDiagnostic>>;

/// A program that has been checked.
pub struct CheckedProgram {
    analysis: Arc<Analysis>,
    found: DiagnosticsByFile,
}

/// The open programs, by the paths of their files.
#[derive(Default)]
pub struct Programs(BTreeMap<String, OpenProgram>);

/// An open program.
#[derive(Default)]
struct OpenProgram {
    state: AnalysisState,
    /// The files that the last check has asked for.
    reads: Arc<Reads>,
    /// The client has not seen its findings as they are now.
    is_unseen: bool,
    /// Its diagnostics, as they were found last.
    found: DiagnosticsByFile,
}

/// What is known of a program as its texts are now.
#[derive(Default)]
enum AnalysisState {
    #[default]
    Unknown,
    UnderWay(JobId),
    Known(Arc<Analysis>),
    /// The check has failed, by a mistake of the server's.
    Failed,
}

/// Whether a program can be spoken of.
pub enum Knowledge {
    /// All that there is.
    Known(Arc<Analysis>),
    /// A check has to come first, or to end.
    Waiting,
    /// The check has failed.
    Failed,
}

impl Programs {
    /// The paths of all of them.
    pub fn paths(&self) -> impl Iterator<Item = &String> {
        self.0.keys()
    }

    /// Takes note that a text has been opened or changed; the programs of which something else is known now than
    /// was before.
    pub fn changed<T>(&mut self, path: &str, jobs: &Jobs<T>) -> BTreeSet<String> {
        self.0.entry(path.to_owned()).or_default();
        self.outdate(jobs, |own, reads| {
            own == path || reads.lack_a_file() || reads.include(path)
        })
    }

    /// Compares all files that are not open with the disk. Returns the programs that have to be checked again.
    pub fn changed_on_disk<T>(
        &mut self,
        documents: &Documents,
        encoding: Encoding,
        jobs: &Jobs<T>,
    ) -> BTreeSet<String> {
        self.outdate(jobs, |_, reads| reads.are_outdated(documents, encoding))
    }

    /// Forgets a program that is closed, and takes note that its text is that of the disk again.
    pub fn closed<T>(&mut self, path: &str, jobs: &Jobs<T>) -> BTreeSet<String> {
        let mut outdated = self.changed(path, jobs);
        self.0.remove(path);
        outdated.insert(path.to_owned());
        outdated
    }

    /// Forgets what is known of some programs, and lets their checks end.
    fn outdate<T>(
        &mut self,
        jobs: &Jobs<T>,
        is_outdated: impl Fn(&str, &Reads) -> bool,
    ) -> BTreeSet<String> {
        let mut outdated = BTreeSet::new();
        for (path, program) in &mut self.0 {
            // A check notes a file before it reads it, and the text has changed before this call. So files that are
            // not noted yet will be read as they are now.
            if !is_outdated(path, &program.reads) {
                continue;
            }
            if let AnalysisState::UnderWay(job) = program.state {
                jobs.cancel(job);
            }
            program.state = AnalysisState::Unknown;
            program.is_unseen = true;
            outdated.insert(path.clone());
        }
        outdated
    }

    /// What is known of a program; `None` if it is not open.
    pub fn known(&self, path: &str) -> Option<Knowledge> {
        Some(match &self.0.get(path)?.state {
            AnalysisState::Known(analysis) => Knowledge::Known(analysis.clone()),
            AnalysisState::Unknown | AnalysisState::UnderWay(_) => Knowledge::Waiting,
            AnalysisState::Failed => Knowledge::Failed,
        })
    }

    /// Whether the findings of a file are still to be found.
    pub fn is_unseen(&self, path: &str) -> bool {
        self.0.get(path).is_some_and(|program| program.is_unseen)
    }

    /// The diagnostics of all programs, by the path of their file.
    pub fn found(&self) -> impl Iterator<Item = (&String, &Vec<LspDiagnostic>)> {
        self.0.values().flat_map(|program| &program.found)
    }

    /// A program that has changed and waits for its check.
    pub fn unchecked(&self) -> Option<&String> {
        let is_unchecked = |program: &OpenProgram| {
            program.is_unseen && matches!(program.state, AnalysisState::Unknown)
        };
        let unchecked = self.0.iter().find(|(_, program)| is_unchecked(program));
        unchecked.map(|(path, _)| path)
    }

    /// Starts the check of a program of which nothing is known, if there is room for it.
    pub fn check<T: From<CheckedProgram> + 'static>(
        &mut self,
        path: &str,
        wanted: JobTrigger,
        documents: &Documents,
        folders: &Arc<[PathBuf]>,
        encoding: Encoding,
        jobs: &mut Jobs<T>,
    ) {
        let Some(program) = self.0.get_mut(path) else {
            return;
        };
        if !matches!(program.state, AnalysisState::Unknown) || !jobs.has_room(wanted) {
            return;
        }
        program.reads = Arc::default();
        let (path, documents, reads) = (path.to_owned(), documents.clone(), program.reads.clone());
        let folders = folders.clone();
        let job = jobs.start(move |cancellation| {
            check(&path, &documents, &reads, &folders, encoding, cancellation).map(T::from)
        });
        program.state = job.map_or(AnalysisState::Failed, AnalysisState::UnderWay);
    }

    /// Takes over what a check has found, unless it is out of date; whether it was a check that is still wanted.
    pub fn checked(&mut self, job: JobId, checked: Option<CheckedProgram>) -> bool {
        let is_it = |program: &&mut OpenProgram| matches!(program.state, AnalysisState::UnderWay(own) if own == job);
        let Some(program) = self.0.values_mut().find(is_it) else {
            return false;
        };
        program.is_unseen = false;
        program.state = match checked {
            Some(checked) => {
                program.found = checked.found;
                AnalysisState::Known(checked.analysis)
            }
            None => AnalysisState::Failed,
        };
        true
    }
}

/// Reads what a program asks for, and takes note of it.
struct ProgramReader<'a> {
    documents: &'a Documents,
    encoding: Encoding,
    reads: &'a Reads,
    bound: ImportFolders,
}

impl Reader for ProgramReader<'_> {
    fn read(&mut self, path: &str) -> Result<Vec<u8>, String> {
        self.reads.read(path, self.documents, self.encoding)
    }

    fn identity(&mut self, path: &str) -> Option<String> {
        identity(path)
    }

    fn outside(&mut self, path: &str) -> Option<String> {
        self.bound.outside(path)
    }
}

/// Checks a program, which may import from these folders, and says which files it has asked for.
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
