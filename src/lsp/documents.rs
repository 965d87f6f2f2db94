//! The texts that the client has open, whether they are saved or not.
use std::collections::BTreeMap;

use gen_lsp_types::TextDocumentContentChangeEvent as Change;

use super::position::{Encoding, Lines};
use super::uri;
use crate::files;

/// Open texts, by the paths of their files.
#[derive(Debug, Default)]
pub struct Documents(BTreeMap<String, Document>);

/// An open text.
#[derive(Debug)]
pub struct Document {
    /// Its address, as the client writes it.
    pub uri: String,
    /// As it is now.
    pub text: String,
    /// The client's number of it.
    pub version: i32,
}

impl Documents {
    /// Opens a text; the path of its file.
    pub fn open(&mut self, uri: String, text: String, version: i32) -> String {
        let path = uri::path(&uri);
        let document = Document { uri, text, version };
        self.0.insert(path.clone(), document);
        path
    }

    /// Changes a text; its path, if it is open.
    pub fn change(
        &mut self,
        uri: &str,
        version: i32,
        changes: Vec<Change>,
        encoding: Encoding,
    ) -> Option<String> {
        let path = uri::path(uri);
        let document = self.0.get_mut(&path)?;
        document.version = version;
        for change in changes {
            match change {
                Change::TextDocumentContentChangePartial(change) => {
                    let lines = Lines::of(&document.text, encoding);
                    let (a, b) = (
                        lines.offset(change.range.start),
                        lines.offset(change.range.end),
                    );
                    document
                        .text
                        .replace_range(a.min(b)..a.max(b), &change.text);
                }
                Change::TextDocumentContentChangeWholeDocument(change) => {
                    document.text = change.text;
                }
            }
        }
        Some(path)
    }

    /// Closes a text; its path.
    pub fn close(&mut self, uri: &str) -> String {
        let path = uri::path(uri);
        self.0.remove(&path);
        path
    }

    /// The open text of a file.
    pub fn get(&self, path: &str) -> Option<&Document> {
        self.0.get(path)
    }

    /// The paths of all open texts.
    pub fn paths(&self) -> impl Iterator<Item = &String> {
        self.0.keys()
    }

    /// The address of a file, as the client writes it if it has it open.
    pub fn uri(&self, path: &str) -> String {
        (self.0.get(path)).map_or_else(|| uri::uri(path), |document| document.uri.clone())
    }

    /// The bytes of a file: what the editor has of it, or else what the disk has.
    ///
    /// # Errors
    ///
    /// Those of [`files::read`].
    pub fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        if let Some(document) = self.0.get(path) {
            return Ok(document.text.clone().into_bytes());
        }
        files::read(path)
    }
}
