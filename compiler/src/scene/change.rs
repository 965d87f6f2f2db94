//! Diagnostics of changes of scene parameters.
use stochc_ir::scene::scalars::ScalarError;

use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic};

/// Returns the diagnostic of an invalid change, at the assembly whose scene is changed.
pub(crate) fn diagnostic(error: &ScalarError, assembly: SourceLocation) -> Diagnostic {
    let code = match error {
        ScalarError::Unknown { .. } => Code::UnknownTerm,
        ScalarError::Absent { .. } => Code::MissingTerm,
        ScalarError::Dimension { .. } => Code::WrongDimension,
        ScalarError::Range { .. } => Code::WrongValue,
    };
    let diagnostic =
        Diagnostic::new(code, error.to_string()).label(assembly, "in the scene of this assembly");
    match error.has() {
        [] => diagnostic,
        has => diagnostic.help(format!("the scene has {}", has.join(", "))),
    }
}
