//! Formats one statement on one line, or on several if it is too long.
use super::line::{FormattedLine, LineKind, columns};
use super::source::{TextPiece, TokenizedText};
use super::spacing::{Breaks, is_blank};
use super::{INDENT, WIDTH};

/// Part of a statement that contains no line break.
struct UnbreakableText {
    text: String,
    /// Indices of the comments before the statement.
    notes: std::ops::Range<usize>,
}

/// Returns the text of a piece on one line.
pub fn text(source: &TokenizedText<'_>, piece: &TextPiece) -> String {
    let mut text = String::new();
    let words = &source.words[piece.words.clone()];
    for (i, word) in words.iter().enumerate() {
        if i > 0 && is_blank(piece.rule, &words[i - 1], word) {
            text.push(' ');
        }
        text.push_str(&word.text());
    }
    text
}

/// Returns the text of a piece on one line. Returns `None` if it has more than `most` columns.
pub fn short_text(source: &TokenizedText<'_>, piece: &TextPiece, most: usize) -> Option<String> {
    // A word has at least one character, so long pieces are rejected early.
    if piece.words.len() > most {
        return None;
    }
    let text = text(source, piece);
    (columns(&text) <= most).then_some(text)
}

/// Wraps a piece into lines. Comments inside it are passed to `note`.
pub fn wrap(
    source: &TokenizedText<'_>,
    piece: &TextPiece,
    depth: usize,
    lines: &mut Vec<FormattedLine>,
    mut note: impl FnMut(&mut Vec<FormattedLine>, usize),
) {
    if !source.is_commented(piece) {
        let room = WIDTH.saturating_sub(INDENT * depth);
        if let Some(text) = short_text(source, piece, room) {
            lines.push(FormattedLine::code(LineKind::Plain, depth, text));
            return;
        }
    }
    let mut current: Option<FormattedLine> = None;
    for (i, chunk) in chunks(source, piece).into_iter().enumerate() {
        for number in chunk.notes {
            lines.extend(current.take());
            note(lines, number);
        }
        match &mut current {
            Some(line) if line.width() + 1 + columns(&chunk.text) <= WIDTH => {
                let text = &mut line.cells[0];
                text.push(' ');
                text.push_str(&chunk.text);
            }
            _ => {
                lines.extend(current.take());
                let (kind, depth) = match i {
                    0 => (LineKind::Plain, depth),
                    _ => (LineKind::Wrapped, depth + 1),
                };
                current = Some(FormattedLine::code(kind, depth, chunk.text));
            }
        }
    }
    lines.extend(current);
}

fn chunks(source: &TokenizedText<'_>, piece: &TextPiece) -> Vec<UnbreakableText> {
    let words = &source.words[piece.words.clone()];
    let mut chunks: Vec<UnbreakableText> = Vec::new();
    let mut breaks = Breaks::default();
    let mut may_break = true;
    for (i, word) in words.iter().enumerate() {
        match chunks.last_mut() {
            Some(chunk) if !may_break && word.notes.is_empty() => {
                if is_blank(piece.rule, &words[i - 1], word) {
                    chunk.text.push(' ');
                }
                chunk.text.push_str(&word.text());
            }
            _ => chunks.push(UnbreakableText {
                text: word.text().into_owned(),
                // Comments before the whole piece are not inside it.
                notes: if i == 0 { 0..0 } else { word.notes.clone() },
            }),
        }
        if let Some(next) = words.get(i + 1) {
            may_break = breaks.may_break(piece.rule, word, next);
        }
    }
    chunks
}
