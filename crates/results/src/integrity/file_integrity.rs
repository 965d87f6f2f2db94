//! Integrity of the files of a results folder.

/// Integrity of one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileIntegrity {
    /// Name within the folder.
    pub name: String,
    /// Integrity.
    pub health: Integrity,
}

/// Integrity of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Integrity {
    /// Its checksums are correct.
    Sound,
    /// It can be read, but has no checksum.
    Unprotected,
    /// It is corrupted, for these reasons.
    Damaged(Vec<String>),
}

impl Integrity {
    /// Returns whether it is corrupted.
    pub fn is_damaged(&self) -> bool {
        matches!(self, Integrity::Damaged(_))
    }

    pub(crate) fn new(damage: Vec<String>, is_protected: bool) -> Integrity {
        match (damage.is_empty(), is_protected) {
            (false, _) => Integrity::Damaged(damage),
            (true, true) => Integrity::Sound,
            (true, false) => Integrity::Unprotected,
        }
    }
}
