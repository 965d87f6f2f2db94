//! The file of a command's `--out` that has to be new.
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
    /// Begins the file; there has to be nothing of its name.
    pub fn begin(path: &Path) -> Result<NewFile, Failure> {
        let draft = Draft::new(path, Replaces::Nothing);
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
