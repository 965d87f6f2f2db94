//! Makes many runs of one or more programs, and stores them in a folder that survives
//! interruptions.
//!
//! [`Manifest`] lists everything that the results depend on. [`Folder`] ensures that only one
//! process writes to a results folder. [`run`] makes the missing runs.
//!
//! ```
//! use std::num::NonZeroUsize;
//! use std::sync::atomic::AtomicBool;
//!
//! use stochc_results::{
//!     Destination, EnsembleProgram, Manifest, Progress, RunCancelled, run,
//! };
//! use stochc_runtime::{Model, Settings};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = "assembly pair { seed plate 3 x 3 { M at (1, 1) }\nphase grow { M.up -> A } }";
//! let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
//! let mut checked = stochc_compiler::check("pair.sa", &mut reader, Default::default());
//! let executable = checked.programs.remove(0).into_executable().ok_or("it is wrong")?;
//! let program = EnsembleProgram::new("pair", Vec::new(), executable);
//!
//! let settings = Settings::new(Model::Shuffle, /* substeps */ 1);
//! let manifest = Manifest::new(settings, /* seed */ 1, /* runs */ 10, vec![program]);
//! let progress = Progress::new(&manifest, NonZeroUsize::MIN);
//! let stop = AtomicBool::new(false);
//! let results = run(Destination::Memory(&manifest), &progress, &stop, |program, number, watch| {
//!     let program = &manifest.programs[program];
//!     let mut on_tick = |tick, phase| watch.tick(tick, phase);
//!     let record = program.run(&manifest.settings_of(program), manifest.seed, number, &mut on_tick);
//!     record.map_err(|_| RunCancelled)
//! })?;
//! assert_eq!(results.finished.to_vec()?.len(), 10);
//! # Ok(())
//! # }
//! ```
mod build;
mod checkpoint;
mod execution;
mod experiment_log;
mod folder;
pub mod integrity;
mod journal;
mod manifest;
pub mod parquet;
pub mod recording;
mod records;
pub mod shards;
pub mod slurm;

pub use build::{other_build, this_build};
pub use checkpoint::{Checkpoints, Interval};
pub use execution::{
    CpuForecast, Destination, EnsembleError, ProgramProgress, Progress, Results, RunCancelled,
    RunWatch, Snapshot, Totals, check_stored, forecast_cpu_time, now, run, time_left, unless,
    until,
};
pub use experiment_log::{ExperimentLog, LogError, RowError};
pub use folder::{
    CHECKPOINTS, Contents, DAMAGED, Folder, FolderError, FolderState, Further, FurtherFiles,
    MANIFEST, Resume, check_manifest, is_remnant, survey, write_tables,
};
pub use journal::JournalError;
pub use manifest::{
    ChosenSetting, Compiled, EnsembleProgram, FORMAT, InvalidSetting, MAX_RUNS, Manifest,
    ManifestError, Source, SweepAxes, Varied,
};
pub use parquet::{
    ColumnShape, ColumnValues, FilledTable, TableShape, each_row_group, table_metadata, tables,
    tables_of,
};
pub use records::{Finished, Records, partial_run, record_json};
