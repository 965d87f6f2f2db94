//! Simulates event tables in a scene.
//!
//! [`run()`] is a pure function from tables, scene, settings, seed and run number to a
//! [record](stochc_ir::record::RunRecord). A [`Controller`](control::Controller) executes the
//! tables, and a [`World`](world::World) moves the blocks. They are independent of each other.
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use stochc_runtime::{Model, Settings, run};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = "assembly pair { seed plate 3 x 3 { M at (1, 1) }\nphase grow { M.up -> A } }";
//! let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
//! let mut checked = stochc_compiler::check("pair.sa", &mut reader, Default::default());
//! let program = checked.programs.remove(0).into_executable().ok_or("it is wrong")?;
//!
//! let settings = Settings::new(Model::Rigid, /* substeps */ 1);
//! let mut watch = |_tick, _phase| ControlFlow::Continue(());
//! let record = run(&program.tables, &program.scene, &settings, /* seed */ 1, /* run */ 0, &mut watch)?;
//! let capture = &record.bonds[0];
//! assert!(capture.docked > capture.magnetized && capture.docked == record.ticks);
//! # Ok(())
//! # }
//! ```
mod aggregate;
pub mod control;
pub mod counter_rng;
pub mod observe;
mod run;
mod run_error;
mod settings;
mod step_error;
mod watch;
pub mod world;

pub use stochc_estimate as rates;
pub use stochc_ir::scene::Substeps;

pub use run::{drive, observe, run};
pub use run_error::RunError;
pub use settings::{Model, Precision, Reduction, Setting, Settings};
pub use step_error::{StepError, step_errors};
pub use watch::{Save, Watch};

/// Digest of this crate's sources. Two builds with equal digests compute equal results.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
