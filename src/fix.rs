//! Application of safe fixes to a program, as `check --fix` does.
use std::io;
use std::path::Path;

use similar::TextDiff;
use stochc_compiler::{self as compiler, Changes, Checked, Limits};
use stochc_files::{atomic, programs};
use stochc_grammar::BYTE_ORDER_MARK;
use stochc_text::visible;

use crate::SourceSettings;
use crate::reader::DiskReader;

/// File and the result of its safe fixes. The fixes are applied only in memory.
#[derive(Debug)]
pub struct FixedFile {
    path: String,
    /// Content of the file as it was read.
    original: Vec<u8>,
    /// Content of the file with all safe fixes.
    pub new: Vec<u8>,
    /// Number of applied fixes.
    pub changes: usize,
    /// Result of checking the original content.
    pub before: Checked,
    /// Result of checking the new content. `None` if there are no fixes.
    pub after: Option<Checked>,
}

/// Applies all safe fixes of a file in memory. Imports may also come from the folders `further`.
/// Does not change imported files.
///
/// # Errors
/// If the file cannot be read.
pub fn fix(path: &str, settings: &SourceSettings) -> io::Result<FixedFile> {
    let original = programs::read(path)?;
    let mut reader = DiskReader::new(path, Some(&original), &settings.imports);
    let values = settings.changes();
    let compiler::Fixed {
        text,
        changes,
        before,
        after,
    } = compiler::fix(
        path,
        &mut reader,
        Limits::default(),
        &settings.levels,
        Changes::everywhere(&values),
    );
    // The compiler skips a byte order mark, so keep it here.
    let mark = BYTE_ORDER_MARK.as_bytes();
    let mark = if original.starts_with(mark) {
        mark
    } else {
        b""
    };
    Ok(FixedFile {
        path: path.to_owned(),
        new: [mark, text.as_bytes()].concat(),
        original,
        changes,
        before,
        after,
    })
}

impl FixedFile {
    /// Returns the changes as a unified diff. Returns an empty text if there are none.
    pub fn diff(&self) -> String {
        if self.changes == 0 {
            return String::new();
        }
        let old = String::from_utf8_lossy(&self.original);
        let new = String::from_utf8_lossy(&self.new);
        TextDiff::from_lines(&*old, &*new)
            .unified_diff()
            .header(&visible(&self.path), &visible(&self.path))
            .to_string()
    }

    /// Replaces the file by its fixed content. Returns `false` and changes nothing if the file was
    /// modified after it was read.
    ///
    /// # Errors
    /// If the file cannot be written. The original file is then intact.
    pub fn write(&self) -> io::Result<bool> {
        atomic::replace_text(Path::new(&self.path), &self.original, &self.new)
    }
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        reason = "the test changes the file without the knowledge of the code"
    )]
    use super::*;

    #[test]
    fn a_concurrently_changed_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sa");
        let text = "assembly a { seed plate 1 x 1 { M at (0, 0) } phaze p { M.up -> A } }";
        std::fs::write(&path, text).unwrap();
        let repaired = fix(path.to_str().unwrap(), &SourceSettings::default()).unwrap();
        assert_eq!(repaired.changes, 1);
        std::fs::write(&path, "// mine\n").unwrap();
        assert!(!repaired.write().unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "// mine\n");
        std::fs::write(&path, text).unwrap();
        assert!(repaired.write().unwrap());
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            text.replace("phaze", "phase")
        );
        let left: Vec<_> = folder.path().read_dir().unwrap().collect();
        assert_eq!(left.len(), 1);
    }
}
