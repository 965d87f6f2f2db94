//! Many runs of one or more programs, kept in a folder that outlives every interruption.
//!
//! [`Manifest`] says what the ensemble depends on, [`Folder`] who may write where, and [`run`]
//! does what is left to do. [`Comparison`] and [`captures`] say what came of it.
//!
//! ```no_run
//! use std::path::Path;
//! use stochc::ensemble::{
//!     Comparison, Display, Folder, Manifest, Means, Place, Program, Source, captures,
//!     captures_to_text, run, stop_on_interrupt,
//! };
//! # use stochc_ir::{Executable, record::RunRecord, table::Tables};
//! use stochc_runtime::{Model, Settings};
//! # fn simulate(_: &Tables, _: u64, _: &mut dyn FnMut(u64, stochc_ir::table::PhaseId) -> bool)
//! #     -> Option<RunRecord> { None }
//! # fn command(text: String, executable: Executable) -> Result<(), Box<dyn std::error::Error>> {
//! let stop = stop_on_interrupt()?;
//! let file = Source { path: "examples/line.sa".into(), text };
//! let program = Program::new("line", vec![file], executable);
//! let settings = Settings { max_ticks: Some(100_000), ..Settings::of(Model::Rapier, /* substeps */ 4) };
//! let manifest = Manifest::new(settings, /* seed */ 1, /* runs */ 50, vec![program]);
//! let place = match Some("results/line") {
//!     Some(out) => Place::Folder(Folder::open(Path::new(out), &manifest, /* --resume */ false)?),
//!     None => Place::Memory(&manifest),
//! };
//! let means = Means {
//!     threads: std::thread::available_parallelism()?,
//!     display: Display::on_standard_error(/* --quiet */ false),
//!     stop,
//! };
//! let results = run(place, means, |program, run, watch| {
//!     // The runtime's way to be watched: told the tick and the phase, it says whether to stop.
//!     let mut told = |tick, phase| watch.tick(tick, phase).is_break();
//!     simulate(manifest.programs[program].tables(), run, &mut told).ok_or(stochc::ensemble::Cancelled)
//! })?;
//! print!("{}", Comparison::of(&manifest, &results.finished).to_text(100));
//! let tick = manifest.programs[0].scene.tick;
//! print!("{}", captures_to_text(&captures(&manifest, &results.finished, 0), tick, 100));
//! # Ok(())
//! # }
//! ```
mod board;
mod build;
mod captures;
mod clock;
mod comparison;
mod contrast;
mod estimate;
mod execute;
mod folder;
mod interrupt;
mod journal;
mod layout;
mod manifest;
mod named;
mod parquet;
mod progress;
mod refusal;
mod run;
mod table;

pub use board::Watch;
pub use build::{other_build, this_build};
pub use captures::{Capture, captures, captures_to_text};
pub(crate) use captures::{Repetitions, Waits, waits};
pub(crate) use clock::now;
pub use comparison::{Column, Comparison, Pair, PhaseTime, Time};
pub use contrast::{Clock, Contrast, Side, Verdict, contrasts};
pub(crate) use contrast::{method, probability, runs, sentence, time};
pub(crate) use estimate::words;
pub use execute::Cancelled;
pub(crate) use folder::RECORDINGS;
pub use folder::{Folder, State};
pub use interrupt::{INTERRUPTED, stop_on_interrupt};
pub use journal::{Finished, JournalError};
pub(crate) use layout::{Layout, paragraph};
pub use manifest::{Compiled, FORMAT, MOST_RUNS, Manifest, Program, Source, Varied};
pub use named::named;
pub use parquet::{ColumnShape, TableShape, tables};
pub use progress::Display;
pub use refusal::FolderError;
pub use run::{Means, Place, Results, RunError, run};
pub(crate) use table::{mean, ticks};
