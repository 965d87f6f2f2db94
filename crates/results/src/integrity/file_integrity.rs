//! How the files of a results folder are.

/// A file of a folder, and what is known of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileIntegrity {
    /// Its name within the folder.
    pub name: String,
    /// How it is.
    pub health: Integrity,
}

/// How a file is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Integrity {
    /// Its checksums are right.
    Sound,
    /// It can be read, but nothing says whether it is as it was written.
    Unprotected,
    /// It is not as it was written: why, in words.
    Damaged(Vec<String>),
}

impl Integrity {
    /// Whether something is wrong.
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
