//! The files that a check has read, so that later changes on the disk are noticed.
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::documents::Documents;
use super::position::Encoding;

/// The files that a check has asked for, by path.
#[derive(Debug, Default)]
pub struct Reads(Mutex<BTreeMap<String, ReadState>>);

/// How far the reading of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ReadState {
    /// It may be read before or after a change.
    Pending,
    Missing,
    /// The digest of its bytes.
    Read(u64),
}

impl Reads {
    fn all(&self) -> MutexGuard<'_, BTreeMap<String, ReadState>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads a file for a check: the open text, or else the file on the disk.
    ///
    /// # Errors
    /// Those of [`Documents::read`].
    pub fn read(
        &self,
        path: &str,
        documents: &Documents,
        encoding: Encoding,
    ) -> Result<Vec<u8>, String> {
        self.all().insert(path.to_owned(), ReadState::Pending);
        let text = documents.read(path, encoding);
        self.all().insert(path.to_owned(), state(&text));
        text
    }

    /// Whether the check has asked for a file.
    pub fn include(&self, path: &str) -> bool {
        self.all().contains_key(path)
    }

    /// Whether a file could not be read.
    pub fn lack_a_file(&self) -> bool {
        self.all()
            .values()
            .any(|state| *state == ReadState::Missing)
    }

    /// Whether a file that is not open has other bytes on the disk now. Reads these files.
    pub fn are_outdated(&self, documents: &Documents, encoding: Encoding) -> bool {
        let all = self.all().clone();
        let mut closed = all.iter().filter(|(path, _)| !documents.is_open(path));
        closed.any(|(path, then)| {
            *then == ReadState::Pending || *then != state(&documents.read(path, encoding))
        })
    }
}

fn state(text: &Result<Vec<u8>, String>) -> ReadState {
    match text {
        Ok(bytes) => {
            let mut hasher = DefaultHasher::new();
            bytes.hash(&mut hasher);
            ReadState::Read(hasher.finish())
        }
        Err(_) => ReadState::Missing,
    }
}
