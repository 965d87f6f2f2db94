//! What is wrong with a change of a scene, as a finding.
use stochc_ir::scene::scalars::ScalarError;

use crate::Site;
use crate::finding::{Code, Finding};

/// What is wrong with a change, as a finding at the assembly whose scene it is.
pub(crate) fn finding(error: &ScalarError, assembly: Site) -> Finding {
    let code = match error {
        ScalarError::Unknown { .. } => Code::UnknownTerm,
        ScalarError::Absent { .. } => Code::MissingTerm,
        ScalarError::Dimension { .. } => Code::WrongDimension,
        ScalarError::Range { .. } => Code::WrongValue,
    };
    let finding = Finding::new(code, error.to_string()).label(assembly, "in the scene of this");
    match error.has() {
        [] => finding,
        has => finding.help(format!("the scene has {}", has.join(", "))),
    }
}
