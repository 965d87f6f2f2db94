//! JSON documents that commands print. `docs/reference/json.md` describes them.
use serde::Serialize;

/// Version of the format of all JSON documents.
pub const FORMAT: u32 = 1;

/// Document with the version of its format. The fields of `content` are at the same level as
/// `format`.
#[derive(Serialize)]
struct Document<T> {
    format: u32,
    #[serde(flatten)]
    content: T,
}

/// Returns a document as JSON with a final line break.
///
/// # Panics
/// If the content is not a JSON object.
pub fn document(content: impl Serialize) -> String {
    let document = Document {
        format: FORMAT,
        content,
    };
    let text = serde_json::to_string_pretty(&document);
    text.expect("the content is an object of plain data") + "\n"
}
