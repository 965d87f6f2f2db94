//! Presentation of the results of ensembles.
//!
//! [`tables`] makes text for a terminal, and [`figures`] makes drawings. [`ensemble_report`] makes
//! a page about ensembles, and [`replay`] a page that replays a run. [`export`] makes files for
//! other applications. All these modules are functions of manifests, records and recordings. They
//! do not write to disk themselves.
//!
//! ```
//! use stochc_experiments::Comparison;
//! use stochc_report::tables::comparison_to_text;
//! use stochc_results::{EnsembleProgram, Finished, Manifest};
//! use stochc_runtime::{Model, Settings};
//!
//! let text = "assembly pair { seed plate 3 x 3 { M at (1, 1) }\nphase grow { M.up -> A } }";
//! let mut checked = stochc_compiler::check_text("pair.sa", text);
//! let executable = checked.programs.remove(0).into_executable().expect("it is right");
//! let program = EnsembleProgram::new("pair", Vec::new(), executable);
//! let settings = Settings::new(Model::Shuffle, /* substeps */ 1);
//! let record = program.run(&settings, 1, 0, &mut |_, _| std::ops::ControlFlow::Continue(()));
//! let finished = Finished { program: 0, record: record.expect("it runs"), cpu: None };
//! let manifest = Manifest::new(settings, /* seed */ 1, /* runs */ 1, vec![program]);
//! let comparison = Comparison::new(&manifest, &[finished]);
//! assert!(comparison_to_text(&comparison, /* width */ 80).contains("pair"));
//! ```
mod analysis;
pub mod ensemble_report;
pub mod estimate;
pub mod export;
pub mod figures;
pub mod presentation;
pub mod replay;
mod svg;
pub mod tables;
mod template;
pub mod text;
