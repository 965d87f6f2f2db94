//! JSON of which every field is known.
use std::fmt;

use serde::Deserialize;
use serde_json::Deserializer;
use serde_json::de::SliceRead;

/// Why JSON is no such value.
#[derive(Debug)]
pub enum StrictJsonError {
    /// It is no JSON, or of something else.
    Damaged(serde_json::Error),
    /// It has a field that means nothing, such as `programs.0.tables.fases`: somebody may have meant it.
    UnknownField(String),
}

/// Reads a value, and refuses fields that it does not have.
///
/// # Errors
/// If it is no such value, or has such a field.
pub fn strict_json<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, StrictJsonError> {
    let mut unknown = None;
    let mut json = Deserializer::new(SliceRead::new(bytes));
    let value = serde_ignored::deserialize(&mut json, |path| {
        unknown.get_or_insert_with(|| path.to_string());
    });
    let value = value.and_then(|value| json.end().map(|()| value));
    match (value, unknown) {
        (Err(error), _) => Err(StrictJsonError::Damaged(error)),
        (Ok(_), Some(path)) => Err(StrictJsonError::UnknownField(path)),
        (Ok(value), None) => Ok(value),
    }
}

impl fmt::Display for StrictJsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StrictJsonError::Damaged(error) => error.fmt(f),
            StrictJsonError::UnknownField(path) => {
                write!(f, "nothing is known of its field `{path}`")
            }
        }
    }
}

impl std::error::Error for StrictJsonError {}
