//! The file of a command's `--out`.
use std::io::Write as _;
use std::path::{Path, PathBuf};

use stochc_files::atomic::{Draft, Replaces};

use crate::exit::Failure;

/// A file that is begun before the work whose outcome it is to hold: where it cannot be written, nobody works in vain.
#[derive(Debug)]
pub struct NewFile {
    draft: Draft,
    path: PathBuf,
}

impl NewFile {
    /// Begins the file.
    ///
    /// # Errors
    /// If it cannot be written, or something has its name that may not be replaced.
    pub fn begin(path: &Path, replaces: Replaces) -> Result<NewFile, Failure> {
        let draft = Draft::new(path, replaces);
        Ok(NewFile {
            draft: draft.map_err(|error| Failure::not_written(path, error))?,
            path: path.to_owned(),
        })
    }

    /// Writes all of it.
    pub fn write(mut self, content: &str) -> Result<(), Failure> {
        let written = self.draft.write_all(content.as_bytes());
        (written.and_then(|()| self.draft.keep()))
            .map_err(|error| Failure::not_written(&self.path, error))
    }
}
