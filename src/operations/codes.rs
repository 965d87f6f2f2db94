//! Lookup of diagnostics by their codes.
use stochc_compiler::diagnostic::{Code, Severity};

/// Name that stands for all warnings in `--allow`, `--warn` and `--deny`.
pub const ALL_WARNINGS: &str = "warnings";

/// Returns the warning with this code. Returns `None` if the name means all warnings.
///
/// # Errors
/// If no warning has this code. The error is a message for the user.
pub fn warning(name: &str) -> Result<Option<Code>, String> {
    if name == ALL_WARNINGS {
        return Ok(None);
    }
    let known = Code::from_name(name);
    if let Some(code) = known.filter(|code| code.severity() == Severity::Warning) {
        return Ok(Some(code));
    }
    Err(match known {
        Some(code) => format!("`{code}` is always an error; only warnings have a level"),
        None => unknown(name, "`stochc explain` lists all codes"),
    })
}

/// Returns the page that explains a code.
///
/// # Errors
/// If no diagnostic has this code. The error is a message for the user.
pub fn explain(name: &str) -> Result<&'static str, String> {
    let code = Code::from_name(name);
    let page = code.map(|code| code.page());
    page.ok_or_else(|| unknown(name, "`stochc explain` lists them all"))
}

fn unknown(name: &str, otherwise: &str) -> String {
    let suggestion = Code::nearest(name).map_or_else(
        || otherwise.to_owned(),
        |suggestion| format!("did you mean `{suggestion}`?"),
    );
    format!("`{name}` is not a code of a warning or error; {suggestion}")
}
