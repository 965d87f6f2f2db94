//! Scene parameters by name, for reading and changing.
use serde::{Deserialize, Serialize};

use super::Scene;
pub use super::scalar_error::ScalarError;
use super::schema::{self, CLAUSES, SchemaNumber};
use stochc_text::suggest::nearest;

/// Returns every parameter of any scene, in the order of the language reference. Parameters that
/// several kinds share are returned once.
pub fn all() -> impl Iterator<Item = &'static SchemaNumber> {
    let all: Vec<_> = CLAUSES.iter().flat_map(schema::numbers).collect();
    // Parameters shared by several kinds of a clause come after their own.
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

/// Returns every parameter that a scene has, in the order of the language reference.
pub fn scalars(scene: &Scene) -> impl Iterator<Item = &'static SchemaNumber> {
    all().filter(|number| number.is_in(scene))
}

/// Returns the parameter of a scene with a full or short name.
///
/// # Errors
///
/// If the name is unknown, or the scene does not have the parameter.
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
    let anywhere = || nearest(name, all().flat_map(|number| number.names).copied());
    // The first word of a name may be a name of its own: `free.count` means `free`.
    let first = || {
        let (first, _) = name.split_once('.')?;
        has().into_iter().find(|known| *known == first)
    };
    // The last word of a name suffices for suggestions: `friction`.
    let last = |number: &&SchemaNumber| number.name().rsplit('.').next() == Some(name);
    let mut ends = scalars(scene).filter(last);
    let suggestion = match (ends.next(), ends.next()) {
        (Some(only), None) => Some(only.name().to_owned()),
        _ => (nearest(name, has()).map(|suggestion| suggestion.word))
            .or_else(|| first().map(str::to_owned))
            .or_else(|| anywhere().map(|suggestion| suggestion.word)),
    };
    Err(ScalarError::Unknown {
        name: name.to_owned(),
        scene: scene.name.clone(),
        suggestion,
        has: has(),
    })
}

/// New value of a scene parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScalarChange {
    /// Name of the parameter, such as `bond.pull`.
    pub name: String,
    /// Value in SI units.
    pub value: f64,
}

/// Returns a scene with changed parameters, applied in an order that respects their dependencies.
///
/// # Errors
///
/// For the first change that is invalid.
pub fn changed(mut scene: Scene, changes: &[ScalarChange]) -> Result<Scene, ScalarError> {
    let mut found = Vec::new();
    for change in changes {
        found.push((find(&scene, &change.name)?, change.value));
    }
    let rank = |name: &str| all().position(|number| number.name() == name);
    found.sort_by_key(|(number, _)| rank(number.name()));
    for (number, value) in found {
        number.set(&mut scene, value)?;
    }
    Ok(scene)
}
