//! Recordings of selected runs, written while the runs are made.
use std::io;
use std::path::Path;
use std::sync::Mutex;

use stochc_files::atomic::{Draft, Replaces, make_own_folder};
use stochc_ir::record::RunRecord;
use stochc_results::recording::{self, Recorder, RecordingHeader, Selection, path};
use stochc_results::{EnsembleProgram, Manifest, Records};
use stochc_runtime::{RunError, Watch};

use crate::exit::Failure;
use crate::host::Host;

/// Writer of the recordings of selected runs.
pub(super) struct Recordings<'a> {
    /// Results folder and selected runs. `None` if no runs are recorded.
    requested: Option<(&'a Path, &'a Selection)>,
    every: u32,
    manifest: &'a Manifest,
    identity: String,
    /// First error of writing a recording. `None` if there was none.
    broken: Mutex<Option<io::Error>>,
}

pub(super) struct RecordingOfRun<'a> {
    all: &'a Recordings<'a>,
    folder: &'a Path,
    program: usize,
    run: u64,
}

impl<'a> Recordings<'a> {
    pub fn new(
        requested: Option<(&'a Path, &'a Selection)>,
        every: u32,
        manifest: &'a Manifest,
    ) -> Recordings<'a> {
        Recordings {
            requested,
            every,
            manifest,
            identity: manifest.identity(),
            broken: Mutex::new(None),
        }
    }

    /// Returns the recording of a run, ready to be written. Returns `None` if the run is not
    /// selected.
    pub fn recording(&'a self, program: usize, run: u64) -> Option<RecordingOfRun<'a>> {
        let (folder, _) = self.requested.filter(|(_, runs)| runs.contains(run))?;
        Some(RecordingOfRun {
            all: self,
            folder,
            program,
            run,
        })
    }

    /// Returns a failure if a recording could not be written. Otherwise warns about selected runs
    /// that have no recording because an earlier command made them.
    pub fn comment(&self, finished: &Records, host: &dyn Host) -> Option<Failure> {
        let (folder, runs) = self.requested?;
        let broken = self.broken.lock().ok().and_then(|mut broken| broken.take());
        if let Some(error) = broken {
            return Some(Failure::usage(format!(
                "cannot keep every recording in `{}`: {error}; the runs themselves are kept",
                folder.display()
            )));
        }
        let requested = (finished.keys()).filter(|&(_, run)| runs.contains(run));
        let missing = requested
            .filter(|&(program, run)| !path(folder, program, run).exists())
            .count();
        if missing > 0 {
            host.note(&format!(
                "note: {missing} of the runs to record had been made before; `stochc replay` makes \
                 such a run again\n"
            ));
        }
        None
    }
}

impl RecordingOfRun<'_> {
    /// Makes a run and records it. If the recording cannot be written, makes the run without it.
    pub fn record(
        &self,
        program: &EnsembleProgram,
        watch: &mut impl Watch,
    ) -> Result<RunRecord, RunError> {
        let settings = &self.all.manifest.settings_of(program);
        let (seed, run) = (self.all.manifest.seed, self.run);
        let (header, path) = (
            self.header(program),
            path(self.folder, self.program, self.run),
        );
        match begin(&path, &header, program) {
            Ok(mut recorder) => {
                let record = program.observe(settings, seed, run, watch, &mut recorder)?;
                if let Err(error) = recorder.finish(&record).and_then(Draft::keep) {
                    self.fail(error);
                }
                Ok(record)
            }
            Err(error) => {
                self.fail(error);
                program.run(settings, seed, run, watch)
            }
        }
    }

    fn header(&self, program: &EnsembleProgram) -> RecordingHeader {
        RecordingHeader {
            stochc: self.all.manifest.stochc.clone(),
            ensemble: self.all.identity.clone(),
            program: self.program,
            run: self.run,
            every: self.all.every,
            bodies: program.scene.free.count,
        }
    }

    fn fail(&self, error: io::Error) {
        if let Ok(mut broken) = self.all.broken.lock() {
            broken.get_or_insert(error);
        }
    }
}

/// Begins a recording at `path`. Creates the folder if needed.
pub(super) fn begin(
    path: &Path,
    header: &RecordingHeader,
    program: &EnsembleProgram,
) -> io::Result<Recorder<Draft>> {
    make_own_folder(path.parent().unwrap_or(Path::new(".")))?;
    let file = Draft::new(path, Replaces::Ours(recording::is_file))?;
    Recorder::new(file, header, program.tables())
}
