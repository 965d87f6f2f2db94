//! Proposed remedies, and the trial of a change.
use crate::diagnostic::{Code, Fix};

/// Code and title of an error.
pub type ReportedError = (Code, String);

/// Function that checks the files with changes of the program's own file. Returns the errors,
/// sorted and not merged. Returns `None` if the changes overlap.
pub type Trial<'a> = dyn Fn(&[&Fix]) -> Option<Vec<ReportedError>> + 'a;

/// Proposed fix: an `after` for each statement that must wait for a block.
#[derive(Clone)]
pub struct Proposal {
    /// Statements as written, each with the name that it must wait for.
    pub waits: Vec<(String, String)>,
    pub fix: Fix,
}
