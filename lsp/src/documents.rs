//! The texts that the client has open, whether they are saved or not.
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use gen_lsp_types::TextDocumentContentChangeEvent as Change;
use stochc_files as files;

use super::position::{Encoding, LineIndex};
use super::uri;

/// Open texts, by the paths of their files; all copies are the same ones, which only one thread changes.
#[derive(Clone, Debug, Default)]
pub struct Documents(Arc<Mutex<BTreeMap<String, Document>>>);

/// An open text.
#[derive(Clone, Debug)]
pub struct Document {
    /// Its address, as the client writes it.
    pub uri: String,
    /// As it is now.
    pub text: Arc<String>,
    /// The client's number of it.
    pub version: i32,
}

impl Documents {
    fn all(&self) -> MutexGuard<'_, BTreeMap<String, Document>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Opens a text; the path of its file.
    pub fn open(&self, uri: String, text: String, version: i32) -> String {
        let path = uri::path(&uri);
        let text = Arc::new(text);
        let document = Document { uri, text, version };
        self.all().insert(path.clone(), document);
        path
    }

    /// Changes a text; its path, if it is open.
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
                    let lines = LineIndex::of(&document.text, encoding);
                    let (a, b) = (
                        lines.offset(change.range.start),
                        lines.offset(change.range.end),
                    );
                    let text = Arc::make_mut(&mut document.text);
                    text.replace_range(a.min(b)..a.max(b), &change.text);
                }
                Change::TextDocumentContentChangeWholeDocument(change) => {
                    document.text = Arc::new(change.text);
                }
            }
        }
        drop(all);
        Some(path)
    }

    /// Closes a text; its path.
    pub fn close(&self, uri: &str) -> String {
        let path = uri::path(uri);
        self.all().remove(&path);
        path
    }

    /// The open text of a file.
    pub fn get(&self, path: &str) -> Option<Document> {
        self.all().get(path).cloned()
    }

    /// The address of a file, as the client writes it if it has it open.
    pub fn uri(&self, path: &str) -> String {
        (self.get(path)).map_or_else(|| uri::uri(path), |document| document.uri)
    }

    /// The bytes of a file: what the editor has of it, or else what the disk has.
    ///
    /// # Errors
    ///
    /// Those of [`files::read`].
    pub fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        if let Some(document) = self.get(path) {
            return Ok(document.text.as_bytes().to_vec());
        }
        files::read(path)
    }
}
