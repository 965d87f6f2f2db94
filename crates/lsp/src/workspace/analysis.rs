//! Analysis of an open program, in the client's terms.
use gen_lsp_types::{Location, Range};
use stochc_compiler::names::{Names, Occurrence};
use stochc_compiler::{
    Cancellation, Cancelled, Checked, FileId, Limits, Reader, SourceLocation, check_cancellable,
};

use super::documents::Documents;
use super::position::{Encoding, LineIndex, line_starts};

/// Analysis of an open program and its imported files.
#[derive(Debug)]
pub struct Analysis {
    /// Results of the compiler.
    pub checked: Checked,
    /// Definitions and references of the program's names.
    pub names: Names,
    /// Character encoding of the client's positions.
    encoding: Encoding,
    /// Starts of the lines of each file.
    lines: Vec<Vec<usize>>,
}

impl Analysis {
    /// Checks the program in a file.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if the check is cancelled.
    pub fn new(
        path: &str,
        reader: &mut dyn Reader,
        encoding: Encoding,
        cancellation: Cancellation<'_>,
    ) -> Result<Analysis, Cancelled> {
        let checked = check_cancellable(path, reader, Limits::EDITOR, cancellation)?;
        let names = Names::new(&checked, cancellation)?;
        let files = checked.sources.files().iter();
        let lines = files.map(|file| line_starts(&file.text)).collect();
        Ok(Analysis {
            checked,
            names,
            encoding,
            lines,
        })
    }

    /// Returns the path of a file.
    pub fn path(&self, file: FileId) -> &str {
        &self.checked.sources.file(file).name
    }

    /// Returns the file with a path. Returns `None` if the file is not part of the program.
    pub fn file(&self, path: &str) -> Option<FileId> {
        let mut files = self.checked.sources.files().iter();
        let number = files.position(|file| file.name == path)?;
        Some(FileId(number as u32))
    }

    /// Returns the lines of a file.
    pub fn lines(&self, file: FileId) -> LineIndex<'_> {
        let text = &self.checked.sources.file(file).text;
        LineIndex::known(text, &self.lines[file.0 as usize], self.encoding)
    }

    /// Returns the range of a span in a file.
    pub fn range(&self, location: SourceLocation) -> Range {
        self.lines(location.file).range(location.span)
    }

    /// Returns a location for the client.
    pub fn location(&self, location: SourceLocation, documents: &Documents) -> Location {
        Location {
            uri: documents.uri(self.path(location.file)).into(),
            range: self.range(location),
        }
    }

    /// Returns the name at a byte of the program's own file. Returns `None` if the byte is not part
    /// of a name.
    pub fn name_at(&self, at: usize) -> Option<&Occurrence> {
        self.names.at(FileId(0), at as u32)
    }
}
