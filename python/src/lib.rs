//! `stochc._native`: what the Python package `stochc` has done in Rust.
//!
//! Arguments have been looked at by the package (`python/stochc/`), and answers are plain: texts of JSON, handles, and
//! tables. Everything is done by [`stochc::operations`], in a [thread of its own](call).
mod call;
mod ensemble;
mod exceptions;
mod host;
mod measure;
mod program;
mod settings;
mod table;

use pyo3::prelude::*;

/// The native part of `stochc`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::ensemble::{PythonEnsemble, merge, open, prepare, report, shard, simulate, status};
    #[pymodule_export]
    use super::measure::{estimate, plan, trade};
    #[pymodule_export]
    use super::program::{PythonProgram, check, explain, load, load_texts};
    #[pymodule_export]
    use super::table::PythonTable;
}
