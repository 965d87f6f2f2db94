//! Conversion of failures to exceptions of `stochc`.
use pyo3::prelude::*;
use stochc::exit::{Exit, Failure};

use super::host::HostLog;

/// Name of the Python module that declares the exceptions.
const MODULE: &str = "stochc._errors";

/// Returns the exception for a failure, including the failures that were reported before.
pub fn exception(py: Python<'_>, failure: &Failure, log: &HostLog) -> PyErr {
    let message = log.failures.clone() + &failure.message;
    let diagnostics = serde_json::Value::from(log.diagnostics.clone()).to_string();
    let kind = match failure.exit {
        Exit::Success | Exit::Usage => "usage",
        Exit::InvalidProgram => "program",
        Exit::UnsuccessfulRun => "run",
        Exit::Interrupted => "interrupted",
    };
    raised(py, kind, &message, &diagnostics)
}

/// Returns the exception for a panic, which is a defect of `stochc` itself.
pub fn defect(py: Python<'_>, panic: &(dyn std::any::Any + Send)) -> PyErr {
    let text = (panic.downcast_ref::<&str>().copied())
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    raised(py, "defect", text.unwrap_or("unknown reason"), "[]")
}

fn raised(py: Python<'_>, kind: &str, message: &str, diagnostics: &str) -> PyErr {
    let made = py
        .import(MODULE)
        .and_then(|module| module.call_method1("made", (kind, message, diagnostics)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Raises the collected warnings.
///
/// # Errors
///
/// The warning as an exception, if the caller turns warnings into errors.
pub fn warn(py: Python<'_>, log: &HostLog) -> PyResult<()> {
    let all = log.rendered.iter().map(|text| ("diagnostics", text));
    let all = all.chain(log.warnings.iter().map(|text| ("note", text)));
    for (kind, text) in all {
        py.import(MODULE)?.call_method1("warn", (kind, text))?;
    }
    Ok(())
}
