//! Event tables and a scene to runs.
//!
//! [`run()`] is the whole of it: a pure function from tables, scene, settings, seed and number of
//! the run to a [record](stochc_ir::record::RunRecord). Inside, a [`Controller`](control::Controller) runs
//! the tables and a [`World`](world::World) moves the blocks; neither knows the other's business.
mod aggregate;
pub mod control;
pub mod counter_rng;
pub mod observe;
mod run;
mod run_error;
mod settings;
mod step_error;
pub mod view;
mod watch;
pub mod world;

pub use stochc_rates as rates;

pub use run::{drive, observe, run};
pub use run_error::RunError;
pub use settings::{Model, Precision, Reduction, Settings, Substeps};
pub use step_error::{StepError, step_errors};
pub use watch::{Save, Watch};

/// A digest of this crate's sources: two builds with one digest compute the same.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
