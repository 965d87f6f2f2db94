//! Ensembles: making them, whole or in pieces, and what their runs tell.
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use stochc::ensemble::recording::Selection;
use stochc::ensemble::shards::{prepare as cut, status as status_of};
use stochc::ensemble::sweep::Axis;
use stochc::ensemble::{
    EnsembleProgram, Interval, JournalError, Manifest, Records, Resume, each_row_group,
    record_json, table_metadata, tables_of,
};
use stochc::exit::{Exit, Failure};
use stochc::host::Host;
use stochc::ir::scene::warnings::Stepping;
use stochc::operations::chosen_run::{ChosenRun, choose, median_run};
use stochc::operations::ensemble::{EnsembleOptions, can_record, judge_scenes, make};
use stochc::operations::results::{ensemble_results, read};
use stochc::operations::runs::{made_again, try_out_all};
use stochc::operations::{export, replay, report as pages, shard as pieces, sweep};
use stochc::report::figures::{self, Figures, Medium};

use super::call::call;
use super::host::Caller;
use super::program::PythonProgram;
use super::settings::{Computed, LevelSetting, levels, parsed};
use super::table::PythonTable;

mod derived;

/// What an ensemble depends on.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EnsembleRequest {
    programs: Vec<Py<PythonProgram>>,
    runs: u64,
    seed: u64,
    sweep: Vec<String>,
    levels: Vec<LevelSetting>,
    computed: Computed,
    threads: Option<u16>,
}

/// What of it, and where it is kept.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct StorageOptions {
    out: Option<PathBuf>,
    resume: bool,
    mixed_builds: bool,
    record: Option<String>,
    record_every: u32,
}

/// The same without the interpreter.
struct Detached {
    asked: EnsembleRequest,
    programs: Vec<EnsembleProgram>,
}

impl EnsembleRequest {
    fn detached(self) -> Detached {
        let programs = self.programs.iter();
        let programs = programs.map(|program| (*program.get().0).clone());
        Detached {
            programs: programs.collect(),
            asked: self,
        }
    }
}

impl Detached {
    /// The manifest, whose scenes can be set up.
    fn manifest(self, record: Option<&Selection>, host: &dyn Host) -> Result<Manifest, Failure> {
        let Detached {
            asked,
            mut programs,
        } = self;
        let axes = asked.sweep.iter().map(|axis| Axis::parse(axis));
        let axes: Result<Vec<_>, _> = axes.collect();
        let axes = axes.map_err(|reason| Failure::usage(format!("sweep: {reason}")))?;
        if !axes.is_empty() {
            let levels = levels(&asked.levels)?;
            programs = sweep::points(&axes, asked.runs, &programs, &levels, host)?;
        }
        let varies_settings = sweep::varies_settings(&axes);
        let settings = if varies_settings {
            asked.computed.given()?
        } else {
            asked.computed.settings(&programs, asked.threads, host)?
        };
        let mut manifest = Manifest::new(settings, asked.seed, asked.runs, programs);
        if varies_settings {
            let known = asked.computed.rates(&manifest.programs, host)?;
            sweep::complete(&mut manifest, &known, asked.threads, host)?;
        }
        manifest.within_limits().map_err(Failure::usage)?;
        can_record(&manifest, record)?;
        try_out_all(&manifest)?;
        let is_checked = manifest.settings.stepping() == Some(Stepping::DEFAULT);
        judge_scenes(&manifest, is_checked, &levels(&asked.levels)?, host)?;
        Ok(manifest)
    }
}

/// Makes an ensemble.
#[pyfunction]
pub fn simulate(
    py: Python<'_>,
    asked: EnsembleRequest,
    kept: StorageOptions,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<PythonEnsemble> {
    let (threads, detached) = (asked.threads, asked.detached());
    call(py, progress.as_ref(), move |host| {
        let record = (kept.record.as_ref())
            .map(|runs| parsed::<Selection>("record", runs))
            .transpose()?;
        let manifest = detached.manifest(record.as_ref(), host)?;
        let how = EnsembleOptions {
            out: kept.out.as_deref(),
            resume: match (kept.resume, kept.mixed_builds) {
                (_, true) => Resume::MixedBuilds,
                (resume, false) => resume.into(),
            },
            record: record.as_ref(),
            record_every: kept.record_every,
            checkpoints: Interval::DEFAULT,
            threads,
            has_warned_of_build: false,
            goes_on: false,
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
            kept.out,
            manifest,
            made.results.finished,
        ))
    })
}

/// The end of work whose caller has stopped it.
fn interrupted() -> Failure {
    Failure {
        exit: Exit::Interrupted,
        message: "stopped; finished runs are kept where there is a folder for them\n".to_owned(),
    }
}

/// Prepares the pieces of an ensemble, and says how many runs it has.
#[pyfunction]
pub fn prepare(py: Python<'_>, asked: EnsembleRequest, out: PathBuf, shards: u64) -> PyResult<u64> {
    let detached = asked.detached();
    call(py, None, move |host| {
        let manifest = detached.manifest(None, host)?;
        cut(&out, &manifest, shards).map_err(Failure::usage)?;
        Ok(manifest.total())
    })
}

/// Makes a piece, and says how many runs it has.
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

/// Which pieces are there, as JSON.
#[pyfunction]
pub fn status(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    call(py, None, move |_| {
        let status = status_of(&folder).map_err(Failure::usage)?;
        let mut document = serde_json::json!(status);
        document["missing"] = serde_json::json!(status.missing().collect::<Vec<_>>());
        Ok(document.to_string())
    })
}

/// Puts the pieces of an ensemble together.
#[pyfunction]
pub fn merge(py: Python<'_>, folder: PathBuf) -> PyResult<PythonEnsemble> {
    call(py, None, move |host| {
        pieces::merge(&folder)?;
        PythonEnsemble::read(folder, host)
    })
}

/// Reads a folder of results.
#[pyfunction]
pub fn open(py: Python<'_>, folder: PathBuf) -> PyResult<PythonEnsemble> {
    call(py, None, move |host| PythonEnsemble::read(folder, host))
}

/// Writes the report on folders, and says where it is.
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

/// The runs of an ensemble.
#[pyclass(frozen, name = "Ensemble", module = "stochc._native")]
pub struct PythonEnsemble(Arc<Inner>);

struct Inner {
    folder: Option<PathBuf>,
    manifest: Manifest,
    /// Of the process that has read them: another one, after a fork, would read the same open files.
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

    /// Asks something of it, without the interpreter's lock.
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
        (program, run): (Option<String>, u64),
        ask: impl FnOnce(&ChosenRun, &Caller) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        self.ask(py, move |inner, finished, host| {
            let ensemble = (inner.manifest.clone(), finished);
            let folder = inner.folder.as_deref();
            let chosen = choose(ensemble, folder, program.as_deref(), run)?;
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

/// Why a table could not be made.
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
    /// The folder that it was read from, or is kept in.
    #[getter]
    fn folder(&self) -> Option<&Path> {
        self.0.folder.as_deref()
    }

    /// How many runs of each program were asked for.
    #[getter]
    fn runs_asked(&self) -> u64 {
        self.0.manifest.runs
    }

    /// The seed of every draw.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.manifest.seed
    }

    /// The name of the model.
    #[getter]
    fn model(&self) -> &'static str {
        self.0.manifest.settings.model.name()
    }

    /// The programs.
    #[getter]
    fn programs(&self) -> Vec<PythonProgram> {
        let programs = self.0.manifest.programs.iter();
        programs.map(|program| program.clone().into()).collect()
    }

    /// SHA-256 of all that decides what a run does.
    #[getter]
    fn identity(&self, py: Python<'_>) -> PyResult<String> {
        self.ask(py, |inner, _, _| Ok(inner.manifest.identity()))
    }

    /// How many runs are finished, of how many.
    fn counts(&self, py: Python<'_>) -> PyResult<(u64, u64)> {
        self.ask(py, |inner, finished, _| {
            Ok((finished.len() as u64, inner.manifest.total()))
        })
    }

    /// A table of its folder, by name.
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

    /// A row for each program.
    fn summary(&self, py: Python<'_>) -> PyResult<PythonTable> {
        self.ask(py, |inner, finished, _| {
            let comparison = ensemble_results(&inner.manifest, finished, false)?.comparison;
            derived::summary(&inner.manifest, &comparison).map_err(Failure::usage)
        })
    }

    /// The curves of Kaplan and Meier.
    fn survival(&self, py: Python<'_>) -> PyResult<PythonTable> {
        self.ask(py, |inner, finished, _| {
            derived::survival(&inner.manifest, finished)
        })
    }

    /// What `stochc show` prints: tables of so many columns, or JSON.
    fn results(&self, py: Python<'_>, bonds: bool, width: Option<usize>) -> PyResult<String> {
        self.ask(py, move |inner, finished, _| {
            let told = ensemble_results(&inner.manifest, finished, bonds)?;
            Ok(match width {
                Some(width) => told.text(width),
                None => told.json(),
            })
        })
    }

    /// Pictures: the completion curves, or those of a sweep; name, title and SVG of each.
    fn pictures(&self, py: Python<'_>) -> PyResult<Vec<(String, String, String)>> {
        self.ask(py, |inner, finished, _| {
            let drawings = match ensemble_results(&inner.manifest, finished, false)?.sweep {
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

    /// A run as `simulate --run N --format json` tells it; it is made if it is not there.
    fn record(&self, py: Python<'_>, program: Option<String>, run: u64) -> PyResult<String> {
        self.chosen(py, (program, run), |chosen, host| {
            let record = match chosen.known() {
                Some(record) => record.clone(),
                None => made_again(&chosen.manifest, host.stop())(chosen.program, chosen.run)
                    .map_err(|_| interrupted())?,
            };
            Ok(record_json(&record, chosen.entry()).to_string())
        })
    }

    /// The number of the run with the median time to completion.
    fn median_run(&self, py: Python<'_>, program: Option<String>) -> PyResult<u64> {
        self.ask(py, move |inner, finished, _| {
            median_run(&inner.manifest, finished, program.as_deref())
        })
    }

    /// The page that shows a run.
    fn replay(&self, py: Python<'_>, program: Option<String>, run: u64) -> PyResult<String> {
        self.chosen(py, (program, run), |chosen, host| {
            replay::page(chosen, &replay::View::default(), host)
        })
    }

    /// Writes the page that shows a run, and says where it is.
    fn write_replay(
        &self,
        py: Python<'_>,
        program: Option<String>,
        run: u64,
        path: PathBuf,
    ) -> PyResult<()> {
        self.chosen(py, (program, run), move |chosen, host| {
            replay::write(chosen, &replay::View::default(), &path, host)
        })
    }

    /// Makes a run again and writes its trajectories: `parquet` or `gltf`.
    fn export(
        &self,
        py: Python<'_>,
        chosen: (Option<String>, u64),
        is_table: bool,
        every: u32,
        path: PathBuf,
    ) -> PyResult<()> {
        self.chosen(py, chosen, move |chosen, host| {
            if is_table {
                export::parquet(chosen, every, &path, host)
            } else {
                export::gltf(chosen, every, &path, host)
            }
        })
    }
}
