//! `stochc._native`: the Rust part of the Python package `stochc`.
//!
//! The package (`python/stochc/`) validates arguments. Functions of this crate return JSON texts,
//! handles, and tables. [`stochc::operations`] does the work, in a [separate thread](call).
mod call;
mod ensemble;
mod exceptions;
mod host;
mod measure;
mod program;
mod settings;
mod table;

use pyo3::prelude::*;

/// Native part of the Python package `stochc`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::ensemble::{PythonEnsemble, merge, open, prepare, report, shard, simulate, status};
    #[pymodule_export]
    use super::measure::{estimate, plan, test, trade};
    #[pymodule_export]
    use super::program::{PythonProgram, check, explain, load, load_texts};
    #[pymodule_export]
    use super::table::PythonTable;
}
