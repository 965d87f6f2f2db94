//! Selection of one run of a results folder, to show or repeat it.
use std::io::{BufReader, ErrorKind, Read, Seek as _};
use std::path::{Path, PathBuf};

use stochc_files as files;
use stochc_files::File;
use stochc_files::atomic::Draft;
use stochc_files::budget::RECORDING;
use stochc_ir::record::RunRecord;
use stochc_results::recording::{EVERY, Outline, Recorder, RecordingError, RecordingHeader, path};
use stochc_results::{EnsembleProgram, Finished, Manifest, Records, until};
use stochc_runtime::observe::Observer;
use stochc_runtime::{Model, RunError};

use super::recordings::begin;
use super::runs::warn_of_build;
use crate::exit::{Exit, Failure};
use crate::host::Host;

/// Run of an ensemble, with all data for repeating it.
#[derive(Debug)]
pub struct ChosenRun {
    /// Results folder of the ensemble. `None` if it is not stored.
    folder: Option<PathBuf>,
    /// Manifest of the whole ensemble.
    pub manifest: Manifest,
    /// Index of the program in the manifest.
    pub program: usize,
    /// Number of the run, from 0.
    pub run: u64,
    /// Stored run. `None` if the run has not been made yet.
    known: Option<Finished>,
}

/// Selects a run of an ensemble. `program` may be `None` if the ensemble has only one program.
///
/// # Errors
/// If the program or the run does not exist.
pub fn choose(
    manifest: Manifest,
    finished: &Records,
    folder: Option<&Path>,
    program: Option<&str>,
    run: u64,
) -> Result<ChosenRun, Failure> {
    let names: Vec<_> = manifest.programs.iter().map(|it| &*it.name).collect();
    let program = index(&names, program, "folder").map_err(Failure::usage)?;
    if run >= manifest.runs {
        let place = folder.map_or(String::new(), |it| format!("`{}`: ", it.display()));
        return Err(Failure::usage(format!(
            "{place}{}",
            manifest.no_such_run(run)
        )));
    }
    let known = finished.get(program, run).map_err(Failure::usage)?;
    Ok(ChosenRun {
        folder: folder.map(Path::to_owned),
        program,
        run,
        known,
        manifest,
    })
}

/// Returns the number of the run with the median completion time. `program` may be `None` if the
/// ensemble has only one program.
///
/// # Errors
/// If the program does not exist, or none of its runs completed.
pub fn median_run(
    manifest: &Manifest,
    finished: &Records,
    program: Option<&str>,
) -> Result<u64, Failure> {
    let names: Vec<_> = manifest.programs.iter().map(|it| &*it.name).collect();
    let program = index(&names, program, "folder").map_err(Failure::usage)?;
    let median = stochc_experiments::median_run(finished, program).map_err(Failure::usage)?;
    median.ok_or_else(|| {
        let name = names[program];
        Failure::usage(format!(
            "no run of `{name}` has a time: choose a run by its number"
        ))
    })
}

/// Returns the index of the program called `name`. `name` may be `None` if there is only one
/// program. `holder` is the word for the folder or file in the error message.
///
/// # Errors
/// If no program has this name, or the name is missing. The error is a message for the user.
pub fn index(names: &[&str], name: Option<&str>, holder: &str) -> Result<usize, String> {
    let listed = || {
        let quoted: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
        quoted.join(", ")
    };
    match name {
        Some(name) => (names.iter())
            .position(|known| *known == name)
            .ok_or_else(|| format!("the {holder} has no program `{name}`, but {}", listed())),
        None if names.len() == 1 => Ok(0),
        None => Err(format!(
            "the {holder} holds several programs; choose one with `--program`: {}",
            listed()
        )),
    }
}

impl ChosenRun {
    /// Returns the program of the run.
    pub fn entry(&self) -> &EnsembleProgram {
        &self.manifest.programs[self.program]
    }

    /// Returns the record of the run. Returns `None` if the run has not been made yet.
    pub fn known(&self) -> Option<&RunRecord> {
        self.known.as_ref().map(|known| &known.record)
    }

    /// Returns the name for a file about this run. The name of the assembly and the run number are
    /// between `before` and `after`.
    pub fn file_name(&self, before: &str, after: &str) -> String {
        // The name of an assembly is a valid word. The name of a program may be any text in an
        // edited manifest.
        let assembly = self.entry().assembly();
        let twins = (self.manifest.programs.iter()).filter(|twin| twin.assembly() == assembly);
        let which = match twins.count() {
            1 => String::new(),
            _ => format!("-{}", self.program),
        };
        format!("{before}{assembly}{which}-{}{after}", self.run)
    }

    /// Repeats the run with an observer. Checks that its record equals the stored record.
    ///
    /// # Errors
    /// If the records differ, or the run is interrupted.
    pub fn again(
        &self,
        observer: &mut impl Observer,
        host: &dyn Host,
    ) -> Result<RunRecord, Failure> {
        let run = self.run;
        let settings = &self.manifest.settings_of(self.entry());
        if settings.model == Model::Measured {
            return Err(Failure::usage(RunError::Measured));
        }
        warn_of_build(&self.manifest.builds, host);
        let mut watch = until(host.stop());
        let record =
            (self.entry()).observe(settings, self.manifest.seed, run, &mut watch, observer);
        let record = record.map_err(|error| match error {
            RunError::Cancelled => Failure::silent(Exit::Interrupted),
            error => Failure::usage(error),
        })?;
        if (self.known.as_ref()).is_some_and(|known| known.record != record) {
            let by = if self.manifest.stochc == env!("CARGO_PKG_VERSION") {
                "the simulation has changed since".to_owned()
            } else {
                format!("it was made by version {}", self.manifest.stochc)
            };
            return Err(Failure::usage(format!(
                "the result of run {run} differs from the one in the folder: {by}; use the `stochc` that made it, \
                 or simulate anew into another folder"
            )));
        }
        Ok(record)
    }

    /// Opens the recording of the run. If there is none, repeats the run, and stores the new
    /// recording if the folder is writable.
    ///
    /// # Errors
    /// If the existing recording is unusable, or [`ChosenRun::again`] fails.
    pub fn recording(&self, host: &dyn Host) -> Result<BufReader<File>, Failure> {
        let folder = self.folder.as_deref();
        let place = folder.map(|folder| path(folder, self.program, self.run));
        if let Some(path) = &place {
            match files::open(path) {
                Ok(file) => return self.checked(file, path),
                Err(error)
                    if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
                Err(error) => return Err(useless(path, &error.to_string())),
            }
        }
        let header = RecordingHeader {
            stochc: self.manifest.stochc.clone(),
            ensemble: self.manifest.identity(),
            program: self.program,
            run: self.run,
            every: EVERY,
            bodies: self.entry().scene.free.count,
        };
        let io =
            |error: std::io::Error| Failure::usage(format!("cannot keep the recording: {error}"));
        if let Some(path) = &place
            && let Ok(mut recorder) = begin(path, &header, self.entry())
        {
            let record = self.again(&mut recorder, host)?;
            recorder.finish(&record).and_then(Draft::keep).map_err(io)?;
            return files::open(path).map(BufReader::new).map_err(io);
        }
        let file = tempfile::tempfile().map_err(io)?;
        let buffered = std::io::BufWriter::new(file);
        let mut recorder = Recorder::new(buffered, &header, self.entry().tables()).map_err(io)?;
        let record = self.again(&mut recorder, host)?;
        let mut file = recorder
            .finish(&record)
            .and_then(|file| {
                file.into_inner()
                    .map_err(std::io::IntoInnerError::into_error)
            })
            .map_err(io)?;
        file.rewind().map_err(io)?;
        Ok(BufReader::new(file.into()))
    }

    /// Checks that a recording is complete and belongs to this run.
    fn checked(&self, file: File, path: &Path) -> Result<BufReader<File>, Failure> {
        let refuse = |reason: &str| useless(path, reason);
        let length = file
            .metadata()
            .map_err(|error| refuse(&error.to_string()))?;
        (RECORDING.admits(length.len())).map_err(|error| refuse(&error.to_string()))?;
        let mut file = BufReader::new(file);
        let recording = Outline::read(file.by_ref(), self.entry().tables());
        let recording = recording.map_err(|error: RecordingError| refuse(&error.to_string()))?;
        if !recording.is_of(&self.manifest, self.known.as_ref(), self.program, self.run) {
            return Err(refuse("it is the recording of another run"));
        }
        file.rewind().map_err(|error| refuse(&error.to_string()))?;
        Ok(file)
    }
}

fn useless(path: &Path, reason: &str) -> Failure {
    let shown = path.display();
    Failure::usage(format!(
        "cannot use `{shown}`: {reason}; remove it, or have `stochc fsck --repair` move it aside, and the run is \
         made and recorded again"
    ))
}
