//! Sources with fixes applied.
use std::collections::BTreeMap;

use super::{Edit, Fix};
use crate::sources::reader::Reader;
use crate::{FileId, Sources};

/// Fixes of one file that do not overlap.
#[derive(Clone, Debug)]
pub struct TextChange<'a> {
    file: FileId,
    text: &'a str,
    /// Maps the first byte of each edit to the end of the replaced bytes and the replacement.
    edits: BTreeMap<usize, (usize, &'a str)>,
}

impl<'a> TextChange<'a> {
    /// Creates an empty change of a file.
    pub fn new(file: FileId, text: &'a str) -> TextChange<'a> {
        TextChange {
            file,
            text,
            edits: BTreeMap::new(),
        }
    }

    /// Returns the changed file.
    pub fn file(&self) -> FileId {
        self.file
    }

    /// Adds a whole fix. Returns whether it fits.
    ///
    /// A fix of another file does not fit. A fix that overlaps with an earlier one does not fit
    /// either. Such fixes may be offered again after the next check.
    pub fn add(&mut self, fix: &'a Fix) -> bool {
        let mut put = Vec::new();
        let fits = fix.edits.iter().all(|edit| {
            let (start, end) = range(edit);
            let fits = edit.location.file == self.file
                && self.text.get(start..end).is_some()
                && is_free(&self.edits, start, end);
            if fits {
                self.edits.insert(start, (end, &edit.text));
                put.push(start);
            }
            fits
        });
        if !fits {
            put.iter().for_each(|start| {
                self.edits.remove(start);
            });
        }
        fits && !put.is_empty()
    }

    /// Returns the changed source.
    pub fn text(&self) -> String {
        let mut out = String::with_capacity(self.text.len());
        let mut at = 0;
        for (&start, &(end, new)) in &self.edits {
            out.push_str(&self.text[at..start]);
            out.push_str(new);
            at = end;
        }
        out.push_str(&self.text[at..]);
        out
    }

    /// Returns a reader that applies this change to the files of a program. Other files are read
    /// with `reader`.
    pub(crate) fn over<'r>(
        &'r self,
        sources: &'r Sources,
        reader: &'r mut dyn Reader,
    ) -> impl Reader + 'r {
        ChangedReader {
            change: self,
            sources,
            reader,
        }
    }

    /// For each byte offset in `places`, returns the range of its possible offsets after the
    /// change. `places` must be sorted. A replaced byte may be anywhere in its replacement.
    pub(crate) fn carried(&self, places: &[usize]) -> Vec<(usize, usize)> {
        let mut edits = self.edits.iter().peekable();
        // Numbers of bytes that earlier edits remove and add.
        let (mut removed, mut added) = (0, 0);
        let carry = |&at: &usize| {
            while let Some(&(&start, &(end, new))) = edits.peek()
                && (end <= at && start < at)
            {
                removed += end - start;
                added += new.len();
                edits.next();
            }
            match edits.peek() {
                Some(&(&start, &(_, new))) if start <= at => {
                    let start = start + added - removed;
                    (start, start + new.len())
                }
                _ => (at + added - removed, at + added - removed),
            }
        };
        places.iter().map(carry).collect()
    }
}

fn range(edit: &Edit) -> (usize, usize) {
    (
        edit.location.span.start as usize,
        edit.location.span.end as usize,
    )
}

/// Returns whether a part of the source is unchanged.
fn is_free(edits: &BTreeMap<usize, (usize, &str)>, start: usize, end: usize) -> bool {
    let before = edits.range(..=start).next_back();
    let behind = edits.range(start..).next();
    before.is_none_or(|(&at, &(until, _))| until <= start && at != start)
        && behind.is_none_or(|(&at, _)| at >= end)
}

/// Reader that replaces sources. See [`TextChange::over`].
struct ChangedReader<'r, 't> {
    change: &'r TextChange<'t>,
    sources: &'r Sources,
    reader: &'r mut dyn Reader,
}

impl Reader for ChangedReader<'_, '_> {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        // Reading removes one byte-order mark.
        let bytes = |text: &str| ["\u{feff}", text].concat().into_bytes();
        let files = self.sources.files();
        let known = files.iter().position(|file| file.name == path);
        match known.map(|number| (FileId(number as u32), &files[number])) {
            Some((id, _)) if id == self.change.file => Ok(bytes(&self.change.text())),
            Some((_, file)) if file.is_exact => Ok(bytes(&file.text)),
            _ => self.reader.read(path),
        }
    }

    fn identity(&mut self, path: &str) -> Option<String> {
        self.reader.identity(path)
    }

    fn outside(&mut self, path: &str) -> Option<String> {
        self.reader.outside(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sources::load::load;
    use crate::{Cancellation, SourceLocation, Span};

    fn fix(edits: &[(u32, u32, &str)]) -> Fix {
        let edits = edits.iter().map(|&(start, end, text)| Edit {
            location: SourceLocation {
                file: FileId(0),
                span: Span::new(start, end),
            },
            text: text.to_owned(),
        });
        Fix {
            title: String::new(),
            edits: edits.collect(),
            safe: true,
        }
    }

    /// Applies all fixes that do not overlap. Returns the new text and the number of applied fixes.
    fn apply_fixes<'a>(
        text: &'a str,
        file: FileId,
        fixes: impl IntoIterator<Item = &'a Fix>,
    ) -> (String, usize) {
        let mut change = TextChange::new(file, text);
        let fitting = fixes.into_iter().filter(|fix| change.add(fix)).count();
        (change.text(), fitting)
    }

    #[test]
    fn the_first_of_two_overlapping_changes_applies() {
        let applied = |fixes: &[Fix]| apply_fixes("0123456789", FileId(0), fixes);
        assert_eq!(
            applied(&[fix(&[(1, 3, "a")]), fix(&[(2, 4, "b")])]),
            ("0a3456789".into(), 1)
        );
        assert_eq!(
            applied(&[fix(&[(2, 4, "b")]), fix(&[(1, 3, "a")])]),
            ("01b456789".into(), 1)
        );
        assert_eq!(
            applied(&[fix(&[(1, 3, "a")]), fix(&[(3, 4, "b")])]),
            ("0ab456789".into(), 2)
        );
        assert_eq!(
            applied(&[fix(&[(1, 1, "a")]), fix(&[(1, 1, "b")])]),
            ("0a123456789".into(), 1)
        );
        assert_eq!(
            applied(&[fix(&[(0, 10, "")]), fix(&[(5, 5, "b")])]),
            (String::new(), 1)
        );
    }

    #[test]
    fn a_change_is_atomic() {
        let two = fix(&[(8, 9, "x"), (1, 2, "y")]);
        assert_eq!(
            apply_fixes("0123456789", FileId(0), &[fix(&[(1, 3, "a")]), two.clone()]),
            ("0a3456789".into(), 1)
        );
        assert_eq!(
            apply_fixes("0123456789", FileId(0), [&two]),
            ("0y234567x9".into(), 1)
        );
        assert_eq!(apply_fixes("012", FileId(0), [&two]), ("012".into(), 0));
        assert_eq!(
            apply_fixes("0123456789", FileId(1), [&two]),
            ("0123456789".into(), 0)
        );
        assert_eq!(
            apply_fixes("0µ2", FileId(0), &[fix(&[(2, 3, "x")])]),
            ("0µ2".into(), 0)
        );
    }

    #[test]
    fn positions_are_mapped_through_a_change() {
        let fixes = [
            fix(&[(1, 3, "abcd")]),
            fix(&[(5, 5, "xy")]),
            fix(&[(7, 9, "")]),
        ];
        let mut change = TextChange::new(FileId(0), "0123456789");
        assert!(fixes.iter().all(|fix| change.add(fix)));
        assert_eq!(change.text(), "0abcd34xy569");
        let places = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
        let carried = [
            (0, 0),
            // Position anywhere in the four inserted letters.
            (1, 5),
            (1, 5),
            (5, 5),
            (6, 6),
            // Before or after the inserted text.
            (7, 9),
            (10, 10),
            (11, 11),
            (11, 11),
            (11, 11),
            (12, 12),
        ];
        assert_eq!(change.carried(&places), carried);
    }

    /// Checks that byte order marks and bytes that are not text stay unchanged, in the changed file
    /// and in others.
    #[test]
    fn unchanged_sources_are_read_again() {
        let files: [(&str, &[u8]); 3] = [
            ("own.sa", b"\xef\xbb\xbfimport \"b.sa\" import \"c.sa\""),
            ("b.sa", b"\xef\xbb\xbf\xef\xbb\xbflet m = 2"),
            ("c.sa", b"let k = \xff"),
        ];
        let mut disk = |path: &str| {
            let file = files.iter().find(|(name, _)| *name == path);
            (file.map(|(_, bytes)| bytes.to_vec())).ok_or(std::io::ErrorKind::NotFound.into())
        };
        let read = |name: &str, reader: &mut dyn Reader| {
            let mut sources = Sources::default();
            load(
                name,
                reader,
                &mut sources,
                Cancellation::NEVER,
                &mut Vec::new(),
            )
            .unwrap();
            sources
        };
        let contents = |sources: &Sources| -> Vec<_> {
            let files = sources.files().iter();
            files
                .map(|it| (it.name.clone(), it.text.clone(), it.is_exact))
                .collect()
        };
        for (name, count) in [("own.sa", 3), ("b.sa", 1)] {
            let before = read(name, &mut disk);
            assert_eq!(before.files().len(), count);
            let none = TextChange::new(FileId(0), &before.files()[0].text);
            let again = read(name, &mut none.over(&before, &mut disk));
            assert_eq!(contents(&again), contents(&before));
        }
    }
}
