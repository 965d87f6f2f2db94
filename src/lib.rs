//! The `stochc` command as a library for Rust programs.
//!
//! Three functions check, compile and simulate a program:
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let text = "assembly pair { seed plate 3 x 3 { M at (1, 1) }\nphase grow { M.up -> A } }";
//! let checked = stochc::check_text("pair.sa", text);
//! let executables = stochc::compile(checked)?;
//! let settings = stochc::runtime::Settings::new(stochc::runtime::Model::Shuffle, 1);
//! let record = stochc::simulate(&executables[0], &settings, /* seed */ 1, /* run */ 0)?;
//! assert_eq!(record.bonds.len(), 1);
//! # Ok(())
//! # }
//! ```
//!
//! For a program with errors, the diagnostics state the errors and how to fix them:
//!
//! ```
//! let checked = stochc::check_text("pair.sa", "assembly pair { }");
//! let error = stochc::compile(checked).unwrap_err();
//! assert_eq!(error.checked.diagnostics.len(), 1);
//! assert!(error.to_string().contains("pair.sa:1:1"), "{error}");
//! ```
//!
//! [`results`] runs ensembles, [`experiments`] compares them, and [`report`] makes pages and
//! tables.
//!
//! The feature `command` adds the command line. It is on by default.
#[cfg(feature = "command")]
pub mod cli;
#[cfg(feature = "command")]
mod command;
pub mod diagnostics;
pub mod exit;
mod facade;
pub mod fix;
pub mod host;
pub mod operations;
pub mod progress;
mod reader;
mod source_settings;

pub use facade::{CompileError, check, check_source, check_with, compile, simulate};
pub use source_settings::{SourceSettings, UnusedValues};
pub use stochc_compiler::{self as compiler, check_text, check_texts};
pub use stochc_control as control;
pub use stochc_experiments as experiments;
pub use stochc_files as files;
pub use stochc_ir as ir;
pub use stochc_lsp as lsp;
pub use stochc_planner as planner;
pub use stochc_report as report;
pub use stochc_results as results;
pub use stochc_runtime as runtime;
pub use stochc_text as text;
