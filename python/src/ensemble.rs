//! Ensembles in Python: simulation, shards and results.
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use stochc::exit::{Exit, Failure};
use stochc::experiments::sweep::Axis;
use stochc::host::Host;
use stochc::ir::scene::warnings::Stepping;
use stochc::operations::chosen_run::{ChosenRun, choose, median_run};
use stochc::operations::ensemble::{EnsembleOptions, can_record, judge_scenes, make};
use stochc::operations::rates::MissingRates;
use stochc::operations::results::{ensemble_results, read};
use stochc::operations::runs::{made_again, try_out_all};
use stochc::operations::{export, replay, report as pages, shard as pieces, sweep};
use stochc::report::figures::{self, Figures, Medium};
use stochc::results::recording::Selection;
use stochc::results::shards::{prepare as split, status as status_of};
use stochc::results::{
    EnsembleProgram, Interval, JournalError, Manifest, Records, Resume, each_row_group,
    record_json, table_metadata, tables_of,
};

use super::call::call;
use super::host::Caller;
use super::program::PythonProgram;
use super::settings::{Computed, LevelSetting, levels, parsed};
use super::table::PythonTable;

mod derived;

/// Python arguments that determine an ensemble.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EnsembleRequest {
    programs: Vec<Py<PythonProgram>>,
    runs: u64,
    seed: u64,
    vary: Vec<String>,
    levels: Vec<LevelSetting>,
    computed: Computed,
    threads: Option<u16>,
}

/// Python arguments for the number of runs and their storage.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct StorageOptions {
    out: Option<PathBuf>,
    resume: bool,
    mixed_builds: bool,
    record: Option<String>,
    record_every: u32,
}

/// Arguments that do not contain objects of the interpreter.
struct Detached {
    request: EnsembleRequest,
    programs: Vec<EnsembleProgram>,
}

impl EnsembleRequest {
    fn detached(self) -> Detached {
        let programs = self.programs.iter();
        let programs = programs.map(|program| (*program.get().0).clone());
        Detached {
            programs: programs.collect(),
            request: self,
        }
    }
}

impl Detached {
    /// Returns the manifest that the arguments determine, after validation.
    fn manifest(self, record: Option<&Selection>, host: &dyn Host) -> Result<Manifest, Failure> {
        let Detached {
            request,
            mut programs,
        } = self;
        let axes = request.vary.iter().map(|axis| Axis::parse(axis));
        let axes: Result<Vec<_>, _> = axes.collect();
        let axes = axes.map_err(|reason| Failure::usage(format!("vary: {reason}")))?;
        if !axes.is_empty() {
            let levels = levels(&request.levels)?;
            programs = sweep::points(&axes, request.runs, &programs, &levels, host)?;
        }
        let varies_settings = sweep::varies_settings(&axes);
        let settings = if varies_settings {
            request.computed.given()?
        } else {
            request
                .computed
                .settings(&programs, request.threads, host)?
        };
        let mut manifest = Manifest::new(settings, request.seed, request.runs, programs);
        if varies_settings {
            let known = request.computed.rates(&manifest.programs, host)?;
            let missing = MissingRates::Calibration(request.threads);
            sweep::complete(&mut manifest, &known, missing, host)?;
        }
        manifest.within_limits().map_err(Failure::usage)?;
        can_record(&manifest, record)?;
        try_out_all(&manifest)?;
        let is_checked = manifest.settings.stepping() == Some(Stepping::DEFAULT);
        judge_scenes(&manifest, is_checked, &levels(&request.levels)?, host)?;
        Ok(manifest)
    }
}

/// Simulates an ensemble and returns its results.
#[pyfunction]
pub fn simulate(
    py: Python<'_>,
    request: EnsembleRequest,
    storage: StorageOptions,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<PythonEnsemble> {
    let (threads, detached) = (request.threads, request.detached());
    call(py, progress.as_ref(), move |host| {
        let record = (storage.record.as_ref())
            .map(|runs| parsed::<Selection>("record", runs))
            .transpose()?;
        let manifest = detached.manifest(record.as_ref(), host)?;
        let how = EnsembleOptions {
            out: storage.out.as_deref(),
            resume: match (storage.resume, storage.mixed_builds) {
                (_, true) => Resume::MixedBuilds,
                (resume, false) => resume.into(),
            },
            record: record.as_ref(),
            record_every: storage.record_every,
            checkpoints: Interval::DEFAULT,
            threads,
            has_warned_of_build: false,
            measures_cpu: false,
            continues: false,
            figures: &Figures::default(),
            watch: false,
            time_limit: None,
        };
        let made = make(&manifest, &how, host)?;
        if !made.results.complete {
            return Err(interrupted());
        }
        made.unrecorded.map_or(Ok(()), Err)?;
        Ok(PythonEnsemble::new(
            storage.out,
            manifest,
            made.results.finished,
        ))
    })
}

/// Returns the failure of work that was interrupted.
fn interrupted() -> Failure {
    Failure {
        exit: Exit::Interrupted,
        message: "stopped; finished runs are kept in the results folder, if there is one\n"
            .to_owned(),
    }
}

/// Splits an ensemble into shards in the folder `out`. Returns the number of runs.
#[pyfunction]
pub fn prepare(
    py: Python<'_>,
    request: EnsembleRequest,
    out: PathBuf,
    shards: u64,
) -> PyResult<u64> {
    let detached = request.detached();
    call(py, None, move |host| {
        let manifest = detached.manifest(None, host)?;
        split(&out, &manifest, shards).map_err(Failure::usage)?;
        Ok(manifest.total())
    })
}

/// Makes the missing runs of a shard. Returns the number of its runs.
#[pyfunction]
pub fn shard(
    py: Python<'_>,
    folder: PathBuf,
    number: u64,
    threads: Option<u16>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<u64> {
    call(py, progress.as_ref(), move |host| {
        let made = pieces::shard(&folder, number, threads, Interval::DEFAULT, host)?;
        made.ok_or_else(interrupted)
    })
}

/// Returns the status of all shards of a folder as JSON.
#[pyfunction]
pub fn status(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    call(py, None, move |_| {
        let status = status_of(&folder).map_err(Failure::usage)?;
        let mut document = serde_json::json!(status);
        document["missing"] = serde_json::json!(status.missing().collect::<Vec<_>>());
        Ok(document.to_string())
    })
}

/// Merges the shards of an ensemble and returns its results.
#[pyfunction]
pub fn merge(py: Python<'_>, folder: PathBuf) -> PyResult<PythonEnsemble> {
    call(py, None, move |host| {
        pieces::merge(&folder)?;
        PythonEnsemble::read(folder, host)
    })
}

/// Reads a results folder.
#[pyfunction]
pub fn open(py: Python<'_>, folder: PathBuf) -> PyResult<PythonEnsemble> {
    call(py, None, move |host| PythonEnsemble::read(folder, host))
}

/// Writes a report on results folders. Returns the path of its page.
#[pyfunction]
pub fn report(
    py: Python<'_>,
    folders: Vec<PathBuf>,
    out: Option<PathBuf>,
    width: Option<String>,
    formats: Vec<String>,
) -> PyResult<PathBuf> {
    call(py, None, move |host| {
        let formats = formats.iter().map(|it| parsed("figure_format", it));
        let width = width.map(|it| parsed("figures", &it)).transpose()?;
        let figures = Figures {
            medium: width.unwrap_or_default(),
            formats: formats.collect::<Result<_, _>>()?,
            ..Figures::default()
        };
        pages::write(&folders, out.as_deref(), &figures, host)
    })
}

/// Ensemble with its runs.
#[pyclass(frozen, name = "Ensemble", module = "stochc._native")]
pub struct PythonEnsemble(Arc<Inner>);

struct Inner {
    folder: Option<PathBuf>,
    manifest: Manifest,
    /// Records of the runs, with the identifier of the process that opened their files. After a
    /// fork, both processes would share the open files.
    finished: Mutex<(u32, Records)>,
}

impl PythonEnsemble {
    fn new(folder: Option<PathBuf>, manifest: Manifest, finished: Records) -> PythonEnsemble {
        PythonEnsemble(Arc::new(Inner {
            folder,
            manifest,
            finished: Mutex::new((std::process::id(), finished)),
        }))
    }

    fn read(folder: PathBuf, host: &dyn Host) -> Result<PythonEnsemble, Failure> {
        let (manifest, finished) = read(&folder, host)?;
        Ok(PythonEnsemble::new(Some(folder), manifest, finished))
    }

    /// Runs a query without the interpreter's lock.
    fn ask<T: Send + 'static>(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&Inner, &Records, &Caller) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        let inner = self.0.clone();
        call(py, None, move |host| {
            let finished = inner.finished(host)?;
            ask(&inner, &finished, host)
        })
    }

    fn chosen<T: Send + 'static>(
        &self,
        py: Python<'_>,
        program: Option<String>,
        run: u64,
        ask: impl FnOnce(&ChosenRun, &Caller) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        self.ask(py, move |inner, finished, host| {
            let folder = inner.folder.as_deref();
            let manifest = inner.manifest.clone();
            let chosen = choose(manifest, finished, folder, program.as_deref(), run)?;
            ask(&chosen, host)
        })
    }
}

impl Inner {
    fn finished(&self, host: &dyn Host) -> Result<Records, Failure> {
        let mut known = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
        let here = std::process::id();
        if let (Some(folder), true) = (&self.folder, known.0 != here) {
            *known = (here, read(folder, host)?.1);
        }
        Ok(known.1.clone())
    }
}

/// Error of making a table from records.
enum RecordsError {
    Journal(JournalError),
    Table(String),
}

impl From<JournalError> for RecordsError {
    fn from(error: JournalError) -> RecordsError {
        RecordsError::Journal(error)
    }
}

#[pymethods]
impl PythonEnsemble {
    /// Returns the results folder. Returns `None` if the ensemble is only in memory.
    #[getter]
    fn folder(&self) -> Option<&Path> {
        self.0.folder.as_deref()
    }

    /// Returns the requested number of runs of each program.
    #[getter]
    fn runs_requested(&self) -> u64 {
        self.0.manifest.runs
    }

    /// Returns the seed of the ensemble.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.manifest.seed
    }

    /// Returns the name of the model.
    #[getter]
    fn model(&self) -> &'static str {
        self.0.manifest.settings.model.name()
    }

    /// Returns the programs of the ensemble.
    #[getter]
    fn programs(&self) -> Vec<PythonProgram> {
        let programs = self.0.manifest.programs.iter();
        programs.map(|program| program.clone().into()).collect()
    }

    /// Returns the identity of the ensemble: the SHA-256 of everything that determines a run.
    #[getter]
    fn identity(&self, py: Python<'_>) -> PyResult<String> {
        self.ask(py, |inner, _, _| Ok(inner.manifest.identity()))
    }

    /// Returns the number of finished runs, and the number of requested runs.
    fn counts(&self, py: Python<'_>) -> PyResult<(u64, u64)> {
        self.ask(py, |inner, finished, _| {
            Ok((finished.len() as u64, inner.manifest.total()))
        })
    }

    /// Returns the table with this name. The tables are those of a results folder.
    fn table(&self, py: Python<'_>, name: String) -> PyResult<PythonTable> {
        self.ask(py, move |inner, finished, _| {
            let manifest = &inner.manifest;
            let mut shapes = tables_of(manifest).into_iter().enumerate();
            let (number, shape) = (shapes.find(|(_, shape)| shape.name == name))
                .ok_or_else(|| Failure::usage(format!("there is no table `{name}`")))?;
            let mut table = PythonTable::new(shape, &table_metadata(manifest));
            let filled = each_row_group((manifest, finished), number, |columns| {
                table.add(columns).map_err(RecordsError::Table)
            });
            filled.map_err(|untold| match untold {
                RecordsError::Journal(error) => Failure::usage(error),
                RecordsError::Table(reason) => Failure::usage(reason),
            })?;
            Ok(table)
        })
    }

    /// Returns the summary table, with a row for each program.
    fn summary(&self, py: Python<'_>) -> PyResult<PythonTable> {
        self.ask(py, |inner, finished, _| {
            let comparison = ensemble_results(&inner.manifest, finished, None)?.comparison;
            derived::summary(&inner.manifest, &comparison).map_err(Failure::usage)
        })
    }

    /// Returns the Kaplan-Meier curves of all programs as a table.
    fn survival(&self, py: Python<'_>) -> PyResult<PythonTable> {
        self.ask(py, |inner, finished, _| {
            derived::survival(&inner.manifest, finished)
        })
    }

    /// Returns the output of `stochc show`. `width` is the width of its tables; without it, the
    /// output is JSON.
    fn results(&self, py: Python<'_>, captures: bool, width: Option<usize>) -> PyResult<String> {
        self.ask(py, move |inner, finished, _| {
            let results =
                ensemble_results(&inner.manifest, finished, captures.then_some(usize::MAX))?;
            Ok(match width {
                Some(width) => results.text(width),
                None => results.json(),
            })
        })
    }

    /// Returns the figures of the ensemble: the completion curves, or the figures of a sweep. Each
    /// has a name, a title and an SVG.
    fn pictures(&self, py: Python<'_>) -> PyResult<Vec<(String, String, String)>> {
        self.ask(py, |inner, finished, _| {
            let drawings = match ensemble_results(&inner.manifest, finished, None)?.sweep {
                Some(sweep) => figures::sweep(Medium::Screen, &sweep, "sweep"),
                None => {
                    let drawing = figures::completion(Medium::Screen, &inner.manifest, finished);
                    drawing.map_err(Failure::usage)?.into_iter().collect()
                }
            };
            let drawings = drawings.into_iter();
            Ok(drawings
                .map(|it| (it.name.clone(), it.title.clone(), it.file()))
                .collect())
        })
    }

    /// Returns the record of a run, in the form of `show DIR --run N --json`. Makes the run if it
    /// is missing.
    fn record(&self, py: Python<'_>, program: Option<String>, run: u64) -> PyResult<String> {
        self.chosen(py, program, run, |chosen, host| {
            let record = match chosen.known() {
                Some(record) => record.clone(),
                None => made_again(&chosen.manifest, host.stop())(chosen.program, chosen.run)
                    .map_err(|_| interrupted())?,
            };
            Ok(record_json(&record, chosen.entry()).to_string())
        })
    }

    /// Returns the number of the run with the median completion time.
    fn median_run(&self, py: Python<'_>, program: Option<String>) -> PyResult<u64> {
        self.ask(py, move |inner, finished, _| {
            median_run(&inner.manifest, finished, program.as_deref())
        })
    }

    /// Returns the replay page of a run as HTML.
    fn replay(&self, py: Python<'_>, program: Option<String>, run: u64) -> PyResult<String> {
        self.chosen(py, program, run, |chosen, host| {
            replay::page(chosen, &replay::View::default(), host)
        })
    }

    /// Writes the replay page of a run to a file.
    fn write_replay(
        &self,
        py: Python<'_>,
        program: Option<String>,
        run: u64,
        path: PathBuf,
    ) -> PyResult<()> {
        self.chosen(py, program, run, move |chosen, host| {
            replay::write(chosen, &replay::View::default(), &path, host)
        })
    }

    /// Repeats a run and writes its trajectories, as a Parquet table or as glTF.
    fn export(
        &self,
        py: Python<'_>,
        chosen: (Option<String>, u64),
        is_table: bool,
        every: u32,
        path: PathBuf,
    ) -> PyResult<()> {
        let (program, run) = chosen;
        self.chosen(py, program, run, move |chosen, host| {
            if is_table {
                export::parquet(chosen, every, &path, host)
            } else {
                export::gltf(chosen, every, &path, host)
            }
        })
    }
}
