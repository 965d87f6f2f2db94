//! The numbers of a scene by their names, to read and to change one by one.
use std::fmt;

use serde::{Deserialize, Serialize};

use super::Scene;
use super::schema::{self, CLAUSES, SchemaNumber};
use crate::suggest::nearest;

/// Every number of any scene, once, in the order of the language reference; of several that share a name, it stands
/// for the one that the scene has.
pub fn all() -> impl Iterator<Item = &'static SchemaNumber> {
    let all: Vec<_> = CLAUSES.iter().flat_map(schema::numbers).collect();
    // What several kinds of a clause share comes behind what is their own.
    let is_last = |i: usize| {
        !all[i + 1..]
            .iter()
            .any(|other| std::ptr::eq(*other, all[i]))
    };
    let last: Vec<_> = (0..all.len())
        .filter(|&i| is_last(i))
        .map(|i| all[i])
        .collect();
    last.into_iter()
}

/// Every number that a scene has a place for, in the order of the language reference.
pub fn scalars(scene: &Scene) -> impl Iterator<Item = &'static SchemaNumber> {
    all().filter(|number| number.is_in(scene))
}

/// The number of a scene that a name stands for: its full name or a short one.
///
/// # Errors
/// When no scene has one of that name, or this one has not.
pub fn find(scene: &Scene, name: &str) -> Result<&'static SchemaNumber, ScalarError> {
    if let Some(found) = scalars(scene).find(|number| number.names.contains(&name)) {
        return Ok(found);
    }
    let has = || scalars(scene).map(SchemaNumber::name).collect::<Vec<_>>();
    let elsewhere = all().find(|number| number.names.contains(&name));
    if let Some(number) = elsewhere {
        let clause = number.clause();
        return Err(ScalarError::Absent {
            name: number.name(),
            scene: scene.name.clone(),
            clause: (!scalars(scene).any(|other| other.clause() == clause)).then_some(clause),
            has: has(),
        });
    }
    let mut known: Vec<&str> = has();
    known.extend(all().flat_map(|number| number.names));
    // What is said of a clause may be found by its last word too: `friction`.
    let last = |number: &&SchemaNumber| number.name().rsplit('.').next() == Some(name);
    let mut ends = scalars(scene).filter(last);
    let meant = match (ends.next(), ends.next()) {
        (Some(only), None) => Some(only.name().to_owned()),
        _ => nearest(name, known).map(|meant| meant.word),
    };
    Err(ScalarError::Unknown {
        name: name.to_owned(),
        scene: scene.name.clone(),
        meant,
        has: has(),
    })
}

/// Another value for a number of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScalarChange {
    /// Its name, such as `bond.pull`.
    pub of: String,
    /// In SI units.
    pub value: f64,
}

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
        /// In SI units.
        value: f64,
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

/// A scene with some of its numbers changed; what depends on another comes after it.
///
/// # Errors
/// For the first change that cannot be made.
pub fn changed(mut scene: Scene, changes: &[ScalarChange]) -> Result<Scene, ScalarError> {
    let mut found = Vec::new();
    for change in changes {
        found.push((find(&scene, &change.of)?, change.value));
    }
    let place = |name: &str| all().position(|number| number.name() == name);
    found.sort_by_key(|(number, _)| place(number.name()));
    for (number, value) in found {
        number.set(&mut scene, value)?;
    }
    Ok(scene)
}
