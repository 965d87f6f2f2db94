//! Sources of the files of a program.
use std::sync::{Arc, OnceLock};

use stochc_grammar::Span;
use stochc_text::is_invisible;

/// Index of a file in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A range in a file of a program.
#[derive(Clone, Copy, Debug)]
pub struct SourceLocation {
    /// Number of the file.
    pub file: FileId,
    /// Range in the file.
    pub span: Span,
}

/// Compares files and positions. Spans in syntax trees are always equal, but two diagnostics are
/// equal only at the same location.
impl PartialEq for SourceLocation {
    fn eq(&self, other: &SourceLocation) -> bool {
        let place =
            |location: &SourceLocation| (location.file, location.span.start, location.span.end);
        place(self) == place(other)
    }
}

impl Eq for SourceLocation {}

/// All read files in the order of reading. The first one is the program's own.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<SourceFile>,
}

/// A source file.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Name in messages.
    pub name: String,
    /// The source.
    pub text: Arc<str>,
    /// Whether the source equals the bytes of the file.
    pub(crate) is_exact: bool,
    /// Number of bytes before the source: a byte-order mark or none.
    pub(crate) mark: u32,
    /// Position of the start of each line.
    lines: Vec<u32>,
    /// Source without control characters, computed on demand.
    shown: OnceLock<Arc<str>>,
}

impl Sources {
    /// Adds a file.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        self.push(name.into(), text.into(), true)
    }

    /// Adds a file that is not UTF-8, with a replacement character for wrong bytes.
    pub(crate) fn add_lossy(&mut self, name: String, text: String) -> FileId {
        self.push(name, text.into(), false)
    }

    fn push(&mut self, name: String, text: Arc<str>, is_exact: bool) -> FileId {
        let newlines = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        let lines = std::iter::once(0)
            .chain(newlines.map(|(at, _)| at as u32 + 1))
            .collect();
        self.files.push(SourceFile {
            name,
            text,
            is_exact,
            mark: 0,
            lines,
            shown: OnceLock::new(),
        });
        FileId(self.files.len() as u32 - 1)
    }

    /// Returns a file.
    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    /// Returns all files.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// Sets the number of bytes before the source of a file.
    pub(crate) fn set_mark(&mut self, id: FileId, bytes: u32) {
        self.files[id.0 as usize].mark = bytes;
    }

    /// Returns the source of a location.
    pub fn text(&self, location: SourceLocation) -> &str {
        let text = &self.file(location.file).text;
        text.get(location.span.start as usize..location.span.end as usize)
            .unwrap_or_default()
    }

    /// Returns the white space at the start of the line of a location.
    pub(crate) fn indent(&self, location: SourceLocation) -> &str {
        let file = self.file(location.file);
        let (start, end) = file.line_range(file.line_of(location.span.start));
        let line = file.text.get(start..end).unwrap_or_default();
        &line[..line.len() - line.trim_start().len()]
    }
}

impl SourceFile {
    /// Returns the position of a byte of the source in the original file, from 0.
    pub fn offset(&self, at: u32) -> u32 {
        self.mark + at
    }

    /// Returns the line and column of a byte, both from 1. Columns count characters.
    pub fn position(&self, at: u32) -> (usize, usize) {
        let line = self.line_of(at);
        let start = self.lines[line] as usize;
        let end = (at as usize).min(self.text.len());
        let column = self
            .text
            .get(start..end)
            .map_or(end.saturating_sub(start), |before| before.chars().count());
        (line + 1, column + 1)
    }

    /// Returns the source with harmless characters of the same length instead of control
    /// characters.
    pub(crate) fn shown(&self) -> &str {
        let hostile = |c: char| is_invisible(c) && !matches!(c, '\n' | '\t');
        self.shown.get_or_init(|| {
            if !self.text.contains(hostile) {
                return self.text.clone();
            }
            let harmless = |c: char| match c.len_utf8() {
                _ if !hostile(c) => c,
                1 if c == '\r' => ' ',
                1 => '?',
                2 => '\u{bf}',
                3 => '\u{fffd}',
                _ => '\u{1fbc4}',
            };
            self.text.chars().map(harmless).collect::<String>().into()
        })
    }

    /// Returns the number of the line of a byte, from 0.
    pub(crate) fn line_of(&self, at: u32) -> usize {
        self.lines.partition_point(|&start| start <= at) - 1
    }

    /// Returns the byte range of a line without its line end. Lines count from 0.
    pub(crate) fn line_range(&self, line: usize) -> (usize, usize) {
        let start = self.lines[line] as usize;
        let end = self
            .lines
            .get(line + 1)
            .map_or(self.text.len(), |&next| next as usize - 1);
        (start, end)
    }

    pub(crate) fn line_count(&self) -> usize {
        self.lines.len()
    }
}
