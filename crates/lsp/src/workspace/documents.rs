//! Documents that are open in the client, saved or not.
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use gen_lsp_types::{Position, TextDocumentContentChangeEvent as Change};
use ropey::Rope;
use stochc_files as files;
use stochc_grammar::BYTE_ORDER_MARK;

use super::position::Encoding;
use super::uri;

/// Open texts by file path. Copies share their content. Only one thread changes the content.
#[derive(Clone, Debug, Default)]
pub struct Documents(Arc<Mutex<BTreeMap<String, Document>>>);

#[derive(Clone, Debug)]
pub struct Document {
    /// URI in the client's spelling.
    pub uri: String,
    /// Current text. A rope makes changes of long texts and copies cheap.
    pub text: Rope,
    /// Version number of the client.
    pub version: i32,
}

impl Document {
    /// Returns the text for the compiler and the formatter. A leading byte order mark, which the
    /// client counts as a character, becomes spaces.
    pub fn program_text(&self, encoding: Encoding) -> String {
        let text = self.text.to_string();
        match text.strip_prefix(BYTE_ORDER_MARK) {
            Some(rest) => " ".repeat(encoding.width(BYTE_ORDER_MARK)) + rest,
            None => text,
        }
    }
}

impl Documents {
    fn all(&self) -> MutexGuard<'_, BTreeMap<String, Document>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens a text and returns its file path.
    pub fn open(&self, uri: String, text: String, version: i32) -> String {
        let path = uri::path(&uri);
        let text = Rope::from(text);
        let document = Document { uri, text, version };
        self.all().insert(path.clone(), document);
        path
    }

    /// Changes an open text and returns its path. Returns `None` if the text is not open.
    pub fn change(
        &self,
        uri: &str,
        version: i32,
        changes: Vec<Change>,
        encoding: Encoding,
    ) -> Option<String> {
        let path = uri::path(uri);
        let mut all = self.all();
        let document = all.get_mut(&path)?;
        document.version = version;
        for change in changes {
            match change {
                Change::TextDocumentContentChangePartial(change) => {
                    let text = &mut document.text;
                    let [a, b] = [change.range.start, change.range.end]
                        .map(|position| offset(text, position, encoding));
                    text.remove(a.min(b)..a.max(b));
                    text.insert(a.min(b), &change.text);
                }
                Change::TextDocumentContentChangeWholeDocument(change) => {
                    document.text = Rope::from(change.text);
                }
            }
        }
        drop(all);
        Some(path)
    }

    /// Closes a text and returns its path.
    pub fn close(&self, uri: &str) -> String {
        let path = uri::path(uri);
        self.all().remove(&path);
        path
    }

    /// Returns the open text of a file. Returns `None` if the file is not open.
    pub fn get(&self, path: &str) -> Option<Document> {
        self.all().get(path).cloned()
    }

    pub fn is_open(&self, path: &str) -> bool {
        self.all().contains_key(path)
    }

    /// Returns the URI of a file, in the client's spelling if it is open.
    pub fn uri(&self, path: &str) -> String {
        (self.get(path)).map_or_else(|| uri::uri(path), |document| document.uri)
    }

    /// Returns the bytes of a file: the open text, otherwise the file on disk.
    ///
    /// # Errors
    ///
    /// The errors of [`files::read`].
    pub fn read(&self, path: &str, encoding: Encoding) -> std::io::Result<Vec<u8>> {
        if let Some(document) = self.get(path) {
            return Ok(document.program_text(encoding).into_bytes());
        }
        files::read(path)
    }
}

/// Returns the character index of a position. For the byte index, use
/// [`LineIndex::offset`](super::position::LineIndex::offset).
fn offset(text: &Rope, position: Position, encoding: Encoding) -> usize {
    let line = position.line as usize;
    if line >= text.len_lines() {
        return text.len_chars();
    }
    let content = text.line(line);
    let within = position.character as usize;
    let breaks = content.chars_at(content.len_chars()).reversed();
    let end = content.len_chars() - breaks.take_while(|c| matches!(c, '\n' | '\r')).count();
    let within = match encoding {
        Encoding::Utf8 => content.byte_to_char(within.min(content.len_bytes())),
        Encoding::Utf16 => content.utf16_cu_to_char(within.min(content.len_utf16_cu())),
    };
    text.line_to_char(line) + within.min(end)
}

#[cfg(test)]
mod tests {
    use gen_lsp_types::{
        Range, TextDocumentContentChangePartial, TextDocumentContentChangeWholeDocument,
    };
    use proptest::prelude::*;

    use super::*;
    use crate::workspace::position::LineIndex;

    fn partial(range: Range, text: &str) -> Change {
        Change::TextDocumentContentChangePartial(TextDocumentContentChangePartial {
            range,
            text: text.to_owned(),
            ..Default::default()
        })
    }

    proptest! {
        /// Compares changes of a document with the same changes of a plain string.
        #[test]
        fn changes_agree_with_a_plain_text(
            start in "[ab\u{b5}\u{1f600}\u{2028}\n\r]{0,30}",
            changes in prop::collection::vec(
                (any::<[(u8, u8); 2]>(), "[ab\u{b5}\u{1f600}\n\r]{0,5}"),
                0..8,
            ),
            is_wide: bool,
        ) {
            let encoding = if is_wide { Encoding::Utf16 } else { Encoding::Utf8 };
            let documents = Documents::default();
            let uri = "file:///x/a.sa";
            let path = documents.open(uri.to_owned(), start.clone(), 0);
            let mut plain = start;
            let mut all = Vec::new();
            for (ends, text) in &changes {
                let [start, end] = ends.map(|(line, character)| Position {
                    line: u32::from(line % 6),
                    character: u32::from(character % 10),
                });
                all.push(partial(Range { start, end }, text));
                let lines = LineIndex::new(&plain, encoding);
                let (a, b) = (lines.offset(start), lines.offset(end));
                plain.replace_range(a.min(b)..a.max(b), text);
            }
            documents.change(uri, 1, all, encoding);
            prop_assert_eq!(documents.get(&path).unwrap().text.to_string(), plain);
        }
    }

    #[test]
    fn a_full_text_replaces_the_document() {
        let documents = Documents::default();
        let path = documents.open("file:///x/a.sa".to_owned(), "old".to_owned(), 0);
        let whole = TextDocumentContentChangeWholeDocument {
            text: "new".to_owned(),
        };
        let whole = Change::TextDocumentContentChangeWholeDocument(whole);
        documents.change("file:///x/a.sa", 1, vec![whole], Encoding::Utf16);
        assert_eq!(documents.read(&path, Encoding::Utf16).unwrap(), b"new");
    }
}
