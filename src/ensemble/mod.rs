//! Many runs of one or more programs, kept in a folder that outlives every interruption.
//!
//! [`Manifest`] says what the ensemble depends on, [`Folder`] who may write where, and [`run`]
//! does what is left to do.
mod atomic;
mod board;
mod clock;
mod comparison;
mod edges;
mod estimate;
mod execute;
mod folder;
mod interrupt;
mod journal;
mod layout;
mod manifest;
mod parquet;
mod progress;
mod run;
mod table;

pub use board::Watch;
pub use comparison::{Column, Comparison, Pair, PhaseTime, Time};
pub use edges::{Edge, edges, edges_to_text};
pub use execute::Cancelled;
pub use folder::{Folder, FolderError, State};
pub use interrupt::{INTERRUPTED, stop_on_interrupt};
pub use journal::{Finished, JournalError};
pub use manifest::{FORMAT, Manifest, Program, Source};
pub use progress::Display;
pub use run::{Means, Place, Results, RunError, run};
