//! The numbers of a scene by their names, to read and to change one by one.
use serde::{Deserialize, Serialize};

use super::Scene;
pub use super::scalar_error::ScalarError;
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
