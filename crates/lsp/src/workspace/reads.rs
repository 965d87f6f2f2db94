//! Files read by a check, for detecting later changes on disk.
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::documents::Documents;
use super::position::Encoding;

/// Files requested by a check, by path.
#[derive(Debug, Default)]
pub struct Reads(Mutex<BTreeMap<String, ReadState>>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ReadState {
    /// The file is being read. It is unknown whether this read includes a later change.
    Pending,
    Missing,
    /// Digest of the file's bytes.
    Read(u64),
}

impl Reads {
    fn all(&self) -> MutexGuard<'_, BTreeMap<String, ReadState>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads a file for a check: the open text, otherwise the file on disk.
    ///
    /// # Errors
    ///
    /// The errors of [`Documents::read`].
    pub fn read(
        &self,
        path: &str,
        documents: &Documents,
        encoding: Encoding,
    ) -> std::io::Result<Vec<u8>> {
        self.all().insert(path.to_owned(), ReadState::Pending);
        let text = documents.read(path, encoding);
        self.all().insert(path.to_owned(), state(&text));
        text
    }

    /// Returns whether the check has requested a file.
    pub fn include(&self, path: &str) -> bool {
        self.all().contains_key(path)
    }

    /// Returns whether a file could not be read.
    pub fn lack_a_file(&self) -> bool {
        self.all()
            .values()
            .any(|state| *state == ReadState::Missing)
    }

    /// Returns whether a file that is not open has changed on disk. Reads these files.
    pub fn are_outdated(&self, documents: &Documents, encoding: Encoding) -> bool {
        let all = self.all().clone();
        let mut closed = all.iter().filter(|(path, _)| !documents.is_open(path));
        closed.any(|(path, then)| {
            *then == ReadState::Pending || *then != state(&documents.read(path, encoding))
        })
    }
}

fn state(text: &std::io::Result<Vec<u8>>) -> ReadState {
    match text {
        Ok(bytes) => {
            let mut hasher = DefaultHasher::new();
            bytes.hash(&mut hasher);
            ReadState::Read(hasher.finish())
        }
        Err(_) => ReadState::Missing,
    }
}
