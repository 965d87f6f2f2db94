//! What can be wrong with a number that is asked for by its name.
use std::fmt;

/// Why a number of a scene cannot be what it was to be.
#[derive(Clone, Debug, PartialEq)]
pub enum ScalarError {
    /// No scene has a number of that name.
    Unknown {
        /// The name.
        name: String,
        /// Of the scene.
        scene: String,
        /// The name that was probably meant.
        meant: Option<String>,
        /// The numbers that the scene has.
        has: Vec<&'static str>,
    },
    /// The scene does not have it.
    Absent {
        /// The full name of the number.
        name: &'static str,
        /// Of the scene.
        scene: String,
        /// The clause that the scene lacks; `None`: it has the clause, of another kind.
        clause: Option<&'static str>,
        /// The numbers that the scene has.
        has: Vec<&'static str>,
    },
    /// The value is of another dimension.
    Dimension {
        /// The full name of the number.
        name: &'static str,
        /// What it has to be.
        expected: &'static str,
        /// What it is.
        found: &'static str,
    },
    /// The value is none that the number may have.
    Range {
        /// The full name of the number.
        name: &'static str,
        /// The value, with its unit.
        value: String,
        /// What it must be, such as `more than 0`.
        rule: String,
    },
}

impl fmt::Display for ScalarError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScalarError::Unknown {
                name, meant, scene, ..
            } => {
                write!(f, "the scene `{scene}` has no number `{name}`")?;
                match meant {
                    Some(meant) => write!(f, "; did you mean `{meant}`?"),
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
    /// The numbers that could be changed instead, or nothing where that is no help.
    pub fn has(&self) -> &[&'static str] {
        match self {
            ScalarError::Unknown { has, .. } | ScalarError::Absent { has, .. } => has,
            ScalarError::Dimension { .. } | ScalarError::Range { .. } => &[],
        }
    }
}
