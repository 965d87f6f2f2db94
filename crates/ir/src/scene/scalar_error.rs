//! Errors of scene parameters given by name.
use std::fmt;

/// Reason why a scene parameter cannot be set.
#[derive(Clone, Debug, PartialEq)]
pub enum ScalarError {
    /// No scene has a parameter with this name.
    Unknown {
        /// Unknown name.
        name: String,
        /// Name of the scene.
        scene: String,
        /// Name that was probably intended.
        suggestion: Option<String>,
        /// Parameters of the scene.
        has: Vec<&'static str>,
    },
    /// The scene does not have the parameter.
    Absent {
        /// Full name of the parameter.
        name: &'static str,
        /// Name of the scene.
        scene: String,
        /// Clause that must be added to the scene. `None` if the scene has the clause, but of
        /// another kind.
        clause: Option<&'static str>,
        /// Parameters of the scene.
        has: Vec<&'static str>,
    },
    /// The value has another dimension.
    Dimension {
        /// Full name of the parameter.
        name: &'static str,
        /// Expected kind of quantity.
        expected: &'static str,
        /// Given kind of quantity.
        found: &'static str,
    },
    /// The value is out of range.
    Range {
        /// Full name of the parameter.
        name: &'static str,
        /// Value with its unit.
        value: String,
        /// Rule for the value, such as `more than 0`.
        rule: String,
    },
}

impl fmt::Display for ScalarError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScalarError::Unknown {
                name,
                suggestion,
                scene,
                ..
            } => {
                write!(f, "the scene `{scene}` has no number `{name}`")?;
                match suggestion {
                    Some(suggestion) => write!(f, "; did you mean `{suggestion}`?"),
                    None => Ok(()),
                }
            }
            ScalarError::Absent {
                name,
                scene,
                clause: Some(clause),
                ..
            } => write!(
                f,
                "the scene `{scene}` declares no `{clause}`, so that there is no `{name}` to change"
            ),
            ScalarError::Absent { name, scene, .. } => {
                write!(f, "the scene `{scene}` does not say `{name}`")
            }
            ScalarError::Dimension {
                name,
                expected,
                found,
            } => {
                let found = found.split(',').next().unwrap_or(found);
                write!(f, "`{name}` is {expected}, not {found}")
            }
            ScalarError::Range { name, value, rule } => {
                write!(f, "`{name}` must be {rule}, and is {value}")
            }
        }
    }
}

impl std::error::Error for ScalarError {}

impl ScalarError {
    /// Returns the parameters of the scene if the error is an unknown or absent parameter.
    /// Otherwise, the list is empty.
    pub fn has(&self) -> &[&'static str] {
        match self {
            ScalarError::Unknown { has, .. } | ScalarError::Absent { has, .. } => has,
            ScalarError::Dimension { .. } | ScalarError::Range { .. } => &[],
        }
    }
}
