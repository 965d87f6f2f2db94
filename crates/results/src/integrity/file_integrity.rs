//! Integrity of the files of a results folder.

/// Integrity of one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileIntegrity {
    /// Name of the file, relative to the results folder.
    pub name: String,
    /// Result of checking the file.
    pub health: Integrity,
}

/// Integrity of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Integrity {
    /// The file's checksums are correct.
    Valid,
    /// The file is readable, but has no checksum.
    Unprotected,
    /// The file is corrupted, for these reasons.
    Corrupted(Vec<String>),
}

impl Integrity {
    /// Returns whether the file is corrupted.
    pub fn is_corrupted(&self) -> bool {
        matches!(self, Integrity::Corrupted(_))
    }

    pub(crate) fn new(damage: Vec<String>, is_protected: bool) -> Integrity {
        match (damage.is_empty(), is_protected) {
            (false, _) => Integrity::Corrupted(damage),
            (true, true) => Integrity::Valid,
            (true, false) => Integrity::Unprotected,
        }
    }
}
