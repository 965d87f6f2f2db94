//! Runs of an ensemble that are recorded while they are made.
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

/// Which runs of an ensemble are recorded, and what went wrong with that.
pub(super) struct Recordings<'a> {
    /// `None`: none.
    wanted: Option<(&'a Path, &'a Selection)>,
    every: u32,
    manifest: &'a Manifest,
    identity: String,
    /// The first.
    broken: Mutex<Option<io::Error>>,
}

/// The place of one recording.
pub(super) struct RecordingOfRun<'a> {
    all: &'a Recordings<'a>,
    folder: &'a Path,
    program: usize,
    run: u64,
}

impl<'a> Recordings<'a> {
    pub fn new(
        wanted: Option<(&'a Path, &'a Selection)>,
        every: u32,
        manifest: &'a Manifest,
    ) -> Recordings<'a> {
        Recordings {
            wanted,
            every,
            manifest,
            identity: manifest.identity(),
            broken: Mutex::new(None),
        }
    }

    /// Where a run is recorded. `None` means it is not.
    pub fn of(&'a self, program: usize, run: u64) -> Option<RecordingOfRun<'a>> {
        let (folder, _) = self.wanted.filter(|(_, runs)| runs.contains(run))?;
        Some(RecordingOfRun {
            all: self,
            folder,
            program,
            run,
        })
    }

    /// Says which of the wanted recordings are not there; why the command fails for that.
    pub fn comment(&self, finished: &Records, host: &dyn Host) -> Option<Failure> {
        let (folder, runs) = self.wanted?;
        let broken = self.broken.lock().ok().and_then(|mut broken| broken.take());
        if let Some(error) = broken {
            return Some(Failure::usage(format!(
                "cannot keep every recording in `{}`: {error}; the runs themselves are kept",
                folder.display()
            )));
        }
        let wanted = (finished.keys()).filter(|&(_, run)| runs.contains(run));
        let missing = wanted
            .filter(|&(program, run)| !path(folder, program, run).exists())
            .count();
        if missing > 0 {
            host.warn(&format!(
                "note: {missing} of the runs to record had been made before; `stochc replay` makes \
                 such a run again\n"
            ));
        }
        None
    }
}

impl RecordingOfRun<'_> {
    /// Makes the run and records it.
    ///
    /// A recording that cannot be written costs the recording, not the run.
    pub fn record(
        &self,
        program: &EnsembleProgram,
        watch: &mut impl Watch,
    ) -> Result<RunRecord, RunError> {
        let settings = &self.all.manifest.settings_of(program);
        let key = (self.all.manifest.seed, self.run);
        let (header, path) = (
            self.header(program),
            path(self.folder, self.program, self.run),
        );
        match begin(&path, &header, program) {
            Ok(mut recorder) => {
                let record = program.observe(settings, key, watch, &mut recorder)?;
                if let Err(error) = recorder.finish(&record).and_then(Draft::keep) {
                    self.fail(error);
                }
                Ok(record)
            }
            Err(error) => {
                self.fail(error);
                program.run(settings, key, watch)
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

/// Begins the recording that will be at `path` in a folder of results, and makes the folder for it.
pub(super) fn begin(
    path: &Path,
    header: &RecordingHeader,
    program: &EnsembleProgram,
) -> io::Result<Recorder<Draft>> {
    make_own_folder(path.parent().unwrap_or(Path::new(".")))?;
    let file = Draft::new(path, Replaces::Ours(recording::is_file))?;
    Recorder::new(file, header, program.tables())
}
