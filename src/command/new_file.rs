//! Output file of the option `--out`.
use std::io::Write as _;
use std::path::{Path, PathBuf};

use stochc_files::atomic::{Draft, Replaces};

use crate::exit::Failure;

/// Output file that is opened before the work starts, so that errors appear before a long
/// computation.
#[derive(Debug)]
pub struct NewFile {
    draft: Draft,
    path: PathBuf,
}

impl NewFile {
    /// Opens the file for writing.
    ///
    /// # Errors
    /// If the file cannot be written, or if `replaces` does not allow replacing it.
    pub fn begin(path: &Path, replaces: Replaces) -> Result<NewFile, Failure> {
        let draft = Draft::new(path, replaces);
        Ok(NewFile {
            draft: draft.map_err(|error| Failure::not_written(path, error))?,
            path: path.to_owned(),
        })
    }

    /// Writes the content and closes the file.
    pub fn write(mut self, content: &str) -> Result<(), Failure> {
        let written = self.draft.write_all(content.as_bytes());
        (written.and_then(|()| self.draft.keep()))
            .map_err(|error| Failure::not_written(&self.path, error))
    }
}
