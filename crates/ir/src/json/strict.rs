//! JSON without unknown fields.
use std::fmt;

use serde::Deserialize;
use serde_json::Deserializer;
use serde_json::de::SliceRead;

/// Error of reading strict JSON.
#[derive(Debug)]
pub enum StrictJsonError {
    /// The text is invalid JSON, or has another type.
    Corrupted(serde_json::Error),
    /// The text has an unknown field, such as `programs.0.tables.fases`, which is probably an
    /// error.
    UnknownField(String),
}

/// Reads a value and rejects unknown fields.
///
/// # Errors
///
/// If the value is invalid or has an unknown field.
pub fn strict_json<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, StrictJsonError> {
    let mut unknown = None;
    let mut json = Deserializer::new(SliceRead::new(bytes));
    let value = serde_ignored::deserialize(&mut json, |path| {
        unknown.get_or_insert_with(|| path.to_string());
    });
    let value = value.and_then(|value| json.end().map(|()| value));
    match (value, unknown) {
        (Err(error), _) => Err(StrictJsonError::Corrupted(error)),
        (Ok(_), Some(path)) => Err(StrictJsonError::UnknownField(path)),
        (Ok(value), None) => Ok(value),
    }
}

impl fmt::Display for StrictJsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StrictJsonError::Corrupted(error) => error.fmt(f),
            StrictJsonError::UnknownField(path) => {
                write!(f, "nothing is known of its field `{path}`")
            }
        }
    }
}

impl std::error::Error for StrictJsonError {}
