//! What is wrong with a change of a scene, as a finding.
use stochc_ir::scene::scalars::ScalarError;

use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic};

/// What is wrong with a change, as a finding at the assembly whose scene it is.
pub(crate) fn diagnostic(error: &ScalarError, assembly: SourceLocation) -> Diagnostic {
    let code = match error {
        ScalarError::Unknown { .. } => Code::UnknownTerm,
        ScalarError::Absent { .. } => Code::MissingTerm,
        ScalarError::Dimension { .. } => Code::WrongDimension,
        ScalarError::Range { .. } => Code::WrongValue,
    };
    let diagnostic =
        Diagnostic::new(code, error.to_string()).label(assembly, "in the scene of this");
    match error.has() {
        [] => diagnostic,
        has => diagnostic.help(format!("the scene has {}", has.join(", "))),
    }
}
