//! JSON that is generated while it is written.
use std::fmt;

use serde::{Serialize, Serializer};
use serde_json::Value;

/// JSON value whose lists are generated element by element during writing, so that large documents
/// need little memory.
///
/// Fields are sorted by name, as in [`Value`]. `{:#}` writes it with indentation, as does
/// [`serde_json::to_writer_pretty`] to a stream.
pub enum Json<'a> {
    /// A small value that is held in memory.
    Value(Value),
    /// Fields, sorted by name.
    Object(Vec<(&'static str, Json<'a>)>),
    /// Generator of the elements.
    List(Box<MakeElements<'a>>),
}

/// Function that starts a new iteration over the elements.
type MakeElements<'a> = dyn Fn() -> Box<dyn Iterator<Item = Json<'a>> + 'a> + 'a;

impl<'a> Json<'a> {
    /// Returns an object.
    pub fn object(fields: impl IntoIterator<Item = (&'static str, Json<'a>)>) -> Json<'a> {
        let mut fields: Vec<_> = fields.into_iter().collect();
        fields.sort_unstable_by_key(|&(name, _)| name);
        Json::Object(fields)
    }

    /// Returns a JSON list of the elements of an iterator. Each time the list is written,
    /// `elements` starts a new iterator.
    pub fn list<I>(elements: impl Fn() -> I + 'a) -> Json<'a>
    where
        I: Iterator<Item = Json<'a>> + 'a,
    {
        Json::List(Box::new(move || Box::new(elements())))
    }

    /// Returns a list with an element for each of `items`.
    pub fn each<T>(items: &'a [T], element: impl Fn(&'a T) -> Json<'a> + Copy + 'a) -> Json<'a> {
        Json::list(move || items.iter().map(element))
    }
}

impl<T: Into<Value>> From<T> for Json<'_> {
    fn from(value: T) -> Self {
        Json::Value(value.into())
    }
}

impl Serialize for Json<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Json::Value(value) => value.serialize(serializer),
            Json::Object(fields) => {
                serializer.collect_map(fields.iter().map(|(name, field)| (name, field)))
            }
            Json::List(elements) => serializer.collect_seq(elements()),
        }
    }
}

impl fmt::Display for Json<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = if out.alternate() {
            serde_json::to_string_pretty(self)
        } else {
            serde_json::to_string(self)
        };
        out.write_str(&text.map_err(|_| fmt::Error)?)
    }
}
