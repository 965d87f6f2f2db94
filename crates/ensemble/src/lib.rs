//! Many runs of one or more programs, kept in a folder that outlives every interruption, and what they say.
//!
//! [`Manifest`] says what the ensemble depends on, [`Folder`] who may write where, and [`run`]
//! does what is left to do. [`Comparison`], [`captures`], [`sweep`] and [`trade`] say what came of it, by [`statistics`].
//!
//! ```
//! use std::num::NonZeroUsize;
//! use std::sync::atomic::AtomicBool;
//!
//! use stochc_ensemble::{
//!     Comparison, Destination, EnsembleProgram, Manifest, Progress, RunCancelled, run,
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
//!     let mut told = |tick, phase| watch.tick(tick, phase);
//!     let record = program.run(&manifest.settings_of(program), (manifest.seed, number), &mut told);
//!     record.map_err(|_| RunCancelled)
//! })?;
//! let comparison = Comparison::new(&manifest, &results.finished.to_vec()?);
//! assert_eq!(comparison.programs[0].completed, 10);
//! # Ok(())
//! # }
//! ```
mod build;
pub mod calibration;
mod captures;
mod checkpoint;
pub mod clock;
mod comparison;
mod executor;
mod file_integrity;
mod file_names;
mod finished;
pub mod fit;
mod folder;
mod folder_checksums;
mod folder_error;
mod forecast;
mod journal;
mod journal_error;
mod journal_line;
mod line_location;
mod manifest;
mod pairwise;
mod parquet;
mod pending_runs;
mod program_events;
mod program_run;
mod progress;
mod record_json;
mod record_validation;
pub mod recording;
mod records;
pub mod resampling;
mod run;
pub mod shards;
pub mod slurm;
mod slurm_folder;
pub mod statistics;
pub mod sweep;
mod thread_time;
mod time_left;
mod times;
pub mod trade;
pub mod verify;

pub use build::{other_build, this_build};
pub use captures::{CaptureKey, CaptureSummary, Repetitions, Waits, WaitsTally, captures};
pub use checkpoint::{Checkpoints, Interval};
pub use comparison::{
    Comparison, ComparisonTally, Pair, PhaseTime, ProgramSummary, Time, last_seen,
};
pub use executor::RunCancelled;
pub use file_names::{CHECKPOINTS, MANIFEST};
pub use finished::Finished;
pub use folder::{
    Contents, Folder, FolderState, Further, FurtherFiles, Resume, check_manifest, is_remnant,
    survey, write_tables,
};
pub use folder_error::FolderError;
pub use forecast::{CpuForecast, forecast_cpu_time};
pub use journal_error::JournalError;
pub use manifest::{
    ChosenSetting, Compiled, EnsembleProgram, FORMAT, MAX_RUNS, Manifest, Source, Varied,
};
pub use pairwise::{ComparedProgram, PairwiseResult, PairwiseTest, TimeUnit, pairwise_tests};
pub use parquet::{
    ColumnShape, ColumnValues, FilledTable, TableShape, each_row_group, summary_table, sweep_table,
    table_metadata, tables, tables_of,
};
pub use program_run::{unless, until};
pub use progress::{ProgramProgress, Progress, RunWatch, Snapshot, Totals};
pub use record_json::record_json;
pub use records::Records;
pub use run::{Destination, EnsembleError, Results, check_stored, run};
pub use time_left::time_left;
pub use times::{completion_status, completion_time, median_run, phase_time, sort_by_time};
