//! What is known of an open program, in the client's terms.
use gen_lsp_types::{Location, Range};
use stochc_compiler::names::{Names, Occurrence};
use stochc_compiler::{Checked, FileId, Limits, Site, check};

use super::documents::Documents;
use super::position::{Encoding, Lines};

/// Everything that is known of an open program and the files it imports.
#[derive(Debug)]
pub struct Analysis {
    /// What the compiler says.
    pub checked: Checked,
    /// What its names refer to.
    pub names: Names,
    /// How the client counts characters.
    pub encoding: Encoding,
}

impl Analysis {
    /// Checks the program in a file.
    pub fn of(path: &str, documents: &Documents, encoding: Encoding) -> Analysis {
        let mut reader = |path: &str| documents.read(path);
        let checked = check(path, &mut reader, Limits::default());
        let names = Names::of(&checked);
        Analysis {
            checked,
            names,
            encoding,
        }
    }

    /// The path of a file.
    pub fn path(&self, file: FileId) -> &str {
        &self.checked.sources.file(file).name
    }

    /// The file with a path, if it is part of the program.
    pub fn file(&self, path: &str) -> Option<FileId> {
        let mut files = self.checked.sources.files().iter();
        let number = files.position(|file| file.name == path)?;
        Some(FileId(number as u32))
    }

    /// The lines of a file.
    pub fn lines(&self, file: FileId) -> Lines<'_> {
        Lines::of(&self.checked.sources.file(file).text, self.encoding)
    }

    /// The range of a span in a file.
    pub fn range(&self, site: Site) -> Range {
        self.lines(site.file).range(site.span)
    }

    /// A place for the client.
    pub fn location(&self, site: Site, documents: &Documents) -> Location {
        Location {
            uri: documents.uri(self.path(site.file)).into(),
            range: self.range(site),
        }
    }

    /// The name at a byte of the program's own file.
    pub fn name_at(&self, at: usize) -> Option<&Occurrence> {
        self.names.at(FileId(0), at as u32)
    }
}
