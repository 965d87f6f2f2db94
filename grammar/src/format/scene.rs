//! Formats the lines of a scene.
//!
//! The grammar does not determine which words of a scene belong together. The formatter therefore
//! keeps line breaks and wide gaps.
use super::line::{FormattedLine, LineKind, columns};
use super::source::{Gap, TextPiece, TokenizedText};
use super::{INDENT, WIDTH, statement};
use crate::parse::{Rule, is_unit};

/// Returns the line that begins at a piece of a scene, the index of the next piece, and whether the
/// line opens a block.
pub fn line(source: &TokenizedText<'_>, at: usize, depth: usize) -> (FormattedLine, usize, bool) {
    let room = WIDTH.saturating_sub(INDENT * depth);
    let mut line = FormattedLine::code(LineKind::Terms, depth, "");
    let mut next = at;
    while let Some(piece) = source.pieces.get(next) {
        let text = &mut line.cells[0];
        if piece.rule == Rule::open {
            if next > at && !source.first(piece).notes.is_empty() {
                break;
            }
            if !text.is_empty() {
                text.push(' ');
            }
            let left = room.saturating_sub(columns(text));
            if let Some((block, behind)) = one_line(source, next, left) {
                text.push_str(&block);
                return (line, behind, false);
            }
            text.push('{');
            line.kind = LineKind::Brace;
            return (line, next + 1, true);
        }
        if !matches!(
            piece.rule,
            Rule::word | Rule::quantity | Rule::span_of_values
        ) || source.is_commented(piece)
        {
            break;
        }
        if next > at {
            let before = &source.pieces[next - 1];
            let word = source.first(piece);
            if word.newlines > 0 || !word.notes.is_empty() || !may_follow(source, before, piece) {
                break;
            }
            let more = format!("{}{}", gap(source, piece), statement::text(source, piece));
            if columns(text) + columns(&more) > room {
                break;
            }
            text.push_str(&more);
        } else {
            text.push_str(&statement::text(source, piece));
        }
        next += 1;
    }
    (line, next, false)
}

/// Returns the text of a short block that is written on one line. Returns `None` for other blocks.
fn one_line(source: &TokenizedText<'_>, at: usize, room: usize) -> Option<(String, usize)> {
    let mut text = String::new();
    let mut depth = 0;
    for (i, piece) in source.pieces[at..].iter().enumerate() {
        let word = source.first(piece);
        let before = &source.pieces[(at + i).saturating_sub(1)];
        let empty = piece.rule == Rule::close && before.rule == Rule::open;
        let apart = !word.notes.is_empty() || (word.newlines > 0 && !empty);
        if source.is_commented(piece) || (i > 0 && apart) {
            return None;
        }
        if i > 0 {
            if !may_follow(source, before, piece) {
                return None;
            }
            let inner = before.rule != Rule::open && piece.rule != Rule::close;
            text.push_str(match inner {
                _ if empty => "",
                true => gap(source, piece),
                _ => " ",
            });
        }
        text.push_str(&statement::short_text(source, piece, room)?);
        if columns(&text) > room {
            return None;
        }
        match piece.rule {
            Rule::open => depth += 1,
            Rule::close => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some((text, at + i + 1));
        }
    }
    None
}

/// Returns whether a word may follow another on one line. For example, `s` after `20 ms` would
/// become a unit.
fn may_follow(source: &TokenizedText<'_>, before: &TextPiece, piece: &TextPiece) -> bool {
    let valued = matches!(before.rule, Rule::quantity | Rule::span_of_values);
    !(valued && piece.rule == Rule::word && is_unit(&source.first(piece).text()))
}

/// Returns the spaces before a piece that shares a line with the previous one. Only a word may have
/// a wide gap before it.
fn gap(source: &TokenizedText<'_>, piece: &TextPiece) -> &'static str {
    match source.first(piece).gap {
        Gap::Wide if piece.rule == Rule::word => "  ",
        _ => " ",
    }
}
