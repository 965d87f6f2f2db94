//! Conversion between bytes of a text and the client's lines and characters.
use std::borrow::Cow;

use gen_lsp_types::{Position, Range};
use stochc_compiler::Span;

/// Unit of the client for counting characters within a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Columns count bytes.
    Utf8,
    /// UTF-16 code units, the default of the protocol.
    #[default]
    Utf16,
}

impl Encoding {
    /// Returns the length of a text in this unit.
    pub fn width(self, text: &str) -> usize {
        match self {
            Encoding::Utf8 => text.len(),
            // Fast path for ASCII, even on long lines.
            Encoding::Utf16 if text.is_ascii() => text.len(),
            Encoding::Utf16 => text.chars().map(char::len_utf16).sum(),
        }
    }
}

/// Text with the starts of its lines. A line ends with `\n`, `\r\n` or `\r`.
#[derive(Clone, Debug)]
pub struct LineIndex<'t> {
    text: &'t str,
    starts: Cow<'t, [usize]>,
    encoding: Encoding,
    /// Change since the text whose bytes the caller uses. Makes `text` the changed text.
    change: Change,
}

/// Change of a text: the replacement of one range of bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Change {
    start: usize,
    old_end: usize,
    new_end: usize,
}

impl Change {
    /// Returns the smallest change between two texts.
    pub fn between(old: &str, new: &str) -> Change {
        let (a, b) = (old.as_bytes(), new.as_bytes());
        let mut start = a.iter().zip(b).take_while(|(a, b)| a == b).count();
        while !old.is_char_boundary(start) || !new.is_char_boundary(start) {
            start -= 1;
        }
        let rest = a[start..].iter().rev().zip(b[start..].iter().rev());
        let mut same = rest.take_while(|(a, b)| a == b).count();
        while !old.is_char_boundary(a.len() - same) || !new.is_char_boundary(b.len() - same) {
            same -= 1;
        }
        Change {
            start,
            old_end: a.len() - same,
            new_end: b.len() - same,
        }
    }

    /// Returns whether a span of the old text contains a difference, or borders on one.
    pub fn touches(self, span: Span) -> bool {
        self.start < self.old_end.max(self.new_end)
            && span.start as usize <= self.old_end
            && self.start <= span.end as usize
    }

    /// Returns the byte of the new text for the end of a range of the old text.
    fn end(self, at: usize) -> usize {
        if at <= self.start {
            at
        } else if at >= self.old_end {
            at - self.old_end + self.new_end
        } else {
            self.start
        }
    }

    /// Returns the byte of the new text for the start of a range of the old text. Differs from the
    /// end of a range where the change is an insertion.
    fn start(self, at: usize) -> usize {
        if at >= self.old_end {
            at - self.old_end + self.new_end
        } else {
            self.end(at)
        }
    }

    /// Returns the byte of the old text for a byte of the new text.
    fn old(self, at: usize) -> usize {
        if at <= self.start {
            at
        } else if at >= self.new_end {
            at - self.new_end + self.old_end
        } else {
            self.start
        }
    }
}

impl<'t> LineIndex<'t> {
    pub fn new(text: &'t str, encoding: Encoding) -> LineIndex<'t> {
        LineIndex::known(text, line_starts(text), encoding)
    }

    /// Returns the index of a text with known [`line_starts`].
    pub fn known(
        text: &'t str,
        starts: impl Into<Cow<'t, [usize]>>,
        encoding: Encoding,
    ) -> LineIndex<'t> {
        LineIndex {
            text,
            starts: starts.into(),
            encoding,
            change: Change::default(),
        }
    }

    /// Returns the index for bytes of the text before a change, and positions after it.
    pub fn changed(self, change: Change) -> LineIndex<'t> {
        LineIndex { change, ..self }
    }

    /// Returns the position of a byte. Bytes beyond the end of the text have the position of the
    /// end.
    pub fn position(&self, at: usize) -> Position {
        self.position_now(self.change.end(at))
    }

    fn position_now(&self, at: usize) -> Position {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        let line = self.starts.partition_point(|&start| start <= at) - 1;
        let before = &self.text[self.starts[line]..at];
        let character = self.encoding.width(before);
        Position {
            line: line as u32,
            character: character as u32,
        }
    }

    /// Returns the range of a span. The range of a deleted span is empty.
    pub fn range(&self, span: Span) -> Range {
        let end = self.change.end(span.end as usize);
        let start = self.change.start(span.start as usize).min(end);
        Range {
            start: self.position_now(start),
            end: self.position_now(end),
        }
    }

    /// Returns the byte of a position. A position beyond the end of its line has the byte of this
    /// end. A position within a character has the first byte of the character.
    pub fn offset(&self, position: Position) -> usize {
        self.change.old(self.offset_now(position))
    }

    /// Returns the bytes of a range, including the one after it.
    pub fn offsets(&self, range: Range) -> std::ops::Range<usize> {
        self.offset(range.start)..self.offset(range.end) + 1
    }

    /// Returns the text of a line up to a position.
    pub fn line_before(&self, position: Position) -> &'t str {
        let start = self.starts.get(position.line as usize);
        let end = self.offset_now(position);
        start.map_or("", |&start| &self.text[start..end])
    }

    fn offset_now(&self, position: Position) -> usize {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else {
            return self.text.len();
        };
        let end = (self.starts.get(line + 1)).map_or(self.text.len(), |&next| next);
        let content = self.text[start..end].trim_end_matches(['\n', '\r']);
        let mut left = position.character as usize;
        for (i, c) in content.char_indices() {
            let width = self.encoding.width(&content[i..i + c.len_utf8()]);
            if left < width {
                return start + i;
            }
            left -= width;
        }
        start + content.len()
    }
}

/// Returns the bytes at the starts of a text's lines.
pub fn line_starts(text: &str) -> Vec<usize> {
    let bytes = text.as_bytes();
    let ends = bytes.iter().enumerate().filter(|&(i, byte)| match byte {
        b'\n' => true,
        b'\r' => bytes.get(i + 1) != Some(&b'\n'),
        _ => false,
    });
    std::iter::once(0).chain(ends.map(|(i, _)| i + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a\u{b5}b\r\n\u{1f9f1}x\ry\n";

    #[test]
    fn characters_are_counted_in_the_agreed_encoding() {
        let at = |text: &str| TEXT.find(text).unwrap();
        for (encoding, b, x) in [(Encoding::Utf16, 2, 2), (Encoding::Utf8, 3, 4)] {
            let lines = LineIndex::new(TEXT, encoding);
            let place = |text| {
                let position = lines.position(at(text));
                (position.line, position.character)
            };
            assert_eq!(place("b"), (0, b));
            assert_eq!(place("x"), (1, x));
            assert_eq!(place("y"), (2, 0));
            assert_eq!(lines.position(TEXT.len()).line, 3);
        }
    }

    #[test]
    fn every_byte_has_a_position() {
        for encoding in [Encoding::Utf8, Encoding::Utf16] {
            let lines = LineIndex::new(TEXT, encoding);
            for (at, c) in TEXT.char_indices().filter(|(_, c)| !"\r\n".contains(*c)) {
                assert_eq!(lines.offset(lines.position(at)), at, "{c:?}");
            }
            for line in 0..6 {
                for character in 0..9 {
                    let offset = lines.offset(Position { line, character });
                    assert!(TEXT.is_char_boundary(offset));
                }
            }
            let far = Position {
                line: 0,
                character: u32::MAX,
            };
            assert_eq!(lines.offset(far), 4);
        }
    }
}
