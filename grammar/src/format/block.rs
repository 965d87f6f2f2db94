//! Arranges statements in lines, with their indentation.
use super::line::{FormattedLine, LineKind, SEAT_GAP, columns};
use super::source::{Note, TextPiece, TokenizedText};
use super::{INDENT, WIDTH, align, scene, statement};
use crate::parse::Rule;

pub fn lay_out(source: &TokenizedText<'_>) -> String {
    let mut layout = LineLayout {
        source,
        lines: Vec::new(),
        depth: 0,
        fresh: true,
        documented: false,
        ended: None,
    };
    let mut at = 0;
    while at < source.pieces.len() {
        at = layout.piece(at);
    }
    for number in source.rest.clone() {
        layout.note(number);
    }
    align::write(layout.lines)
}

/// The formatted lines so far, with the state of the layout.
pub struct LineLayout<'s, 't> {
    pub source: &'s TokenizedText<'t>,
    pub lines: Vec<FormattedLine>,
    /// Number of open blocks.
    pub depth: usize,
    /// Whether the innermost block is empty so far.
    fresh: bool,
    /// Whether the last token was a `///` comment.
    documented: bool,
    /// Whether the last item at the top level was a block. `None` before the first item.
    ended: Option<bool>,
}

impl LineLayout<'_, '_> {
    /// Lays out a piece, and further pieces on the same line. Returns the index of the next piece.
    fn piece(&mut self, at: usize) -> usize {
        let piece = &self.source.pieces[at];
        let apart = self.is_set_apart(at);
        let first = self.lines.len();
        for number in self.source.first(piece).notes.clone() {
            self.note(number);
        }
        let own_notes =
            (self.lines[first..].iter()).position(|line| line.kind == LineKind::Comment);
        if piece.rule == Rule::close {
            self.depth = self.depth.saturating_sub(1);
        }
        let start = self.lines.len();
        let next = self.code(at);
        let blank = self.source.first(piece).newlines > 1
            && !self.fresh
            && !self.documented
            && piece.rule != Rule::close;
        if let Some(line) = self.lines.get_mut(start) {
            line.blank |= blank;
        }
        if apart && let Some(line) = self.lines.get_mut(own_notes.map_or(start, |i| first + i)) {
            line.blank = true;
        }
        let last = self.source.pieces[at..next].last().map(|last| last.rule);
        self.fresh = last.is_some_and(opens);
        self.documented = piece.rule == Rule::doc;
        if self.depth == 0 && !self.documented {
            self.ended = Some(last == Some(Rule::close));
        }
        next
    }

    /// Returns whether the layout always writes a blank line before the piece. Blocks at the top
    /// level are surrounded by blank lines.
    fn is_set_apart(&self, at: usize) -> bool {
        let (Some(was_block), 0, false) = (self.ended, self.depth, self.documented) else {
            return false;
        };
        let source = self.source;
        let documented = source.pieces[at..].iter();
        let item = documented.clone().find(|piece| piece.rule != Rule::doc);
        if !was_block && !item.is_some_and(|item| opens(item.rule)) {
            return false;
        }
        // A blank line in the source may stand before or after a comment.
        let first = source.first(&source.pieces[at]);
        let is_wide = |newlines: u32| newlines > 1;
        let notes = &source.notes[first.notes.clone()];
        !is_wide(first.newlines) && !notes.iter().any(|note| is_wide(note.newlines))
    }

    fn code(&mut self, at: usize) -> usize {
        let source = self.source;
        let piece = &source.pieces[at];
        match piece.rule {
            Rule::close => {
                let alternative = self.alternative(at + 1);
                let text = alternative
                    .as_ref()
                    .map_or_else(|| "}".to_owned(), |head| format!("}} {head}"));
                self.lines
                    .push(FormattedLine::code(LineKind::Brace, self.depth, text));
                self.depth += usize::from(alternative.is_some());
                at + 1 + usize::from(alternative.is_some())
            }
            Rule::doc => {
                let mut line = FormattedLine::code(LineKind::Comment, self.depth, "");
                line.note = Some(statement::text(source, piece));
                self.lines.push(line);
                at + 1
            }
            Rule::word | Rule::quantity | Rule::span_of_values | Rule::open => self.terms(at),
            Rule::seat => self.seats(at),
            rule if opens(rule) => self.head(at),
            _ => {
                self.statement(at);
                at + 1
            }
        }
    }

    /// Returns the head of an `else` or `on timeout` that can stand on the line of the brace before it.
    fn alternative(&self, at: usize) -> Option<String> {
        let source = self.source;
        let head = source
            .pieces
            .get(at)
            .filter(|it| matches!(it.rule, Rule::if_head | Rule::handler_head))?;
        let has_comments = source.is_commented(head) || !source.first(head).notes.is_empty();
        let room = WIDTH.saturating_sub(INDENT * self.depth + "} ".len());
        (statement::short_text(source, head, room))
            .filter(|text| !has_comments && !text.starts_with("if"))
    }

    fn statement(&mut self, at: usize) {
        let source = self.source;
        statement::wrap(
            source,
            &source.pieces[at],
            self.depth,
            &mut self.lines,
            |lines, number| push_note(lines, &source.notes[number], self.depth + 1, false),
        );
    }

    /// Lays out the head of a block. A short block is laid out on one line, including its content.
    /// Returns the index of the next piece.
    fn head(&mut self, at: usize) -> usize {
        if let Some((text, next)) = self.one_line(at) {
            self.lines
                .push(FormattedLine::code(LineKind::Plain, self.depth, text));
            return next;
        }
        let start = self.lines.len();
        self.statement(at);
        if let Some(line) = self.lines[start..].last_mut() {
            line.kind = LineKind::Brace;
        }
        self.depth += 1;
        match self.source.pieces[at].rule {
            Rule::layer_head => self.rows(at + 1),
            _ => at + 1,
        }
    }

    /// Returns the text of a block on one line. The block must be empty, or written on one line
    /// with one statement or a row of seeds. Otherwise returns `None`.
    fn one_line(&self, at: usize) -> Option<(String, usize)> {
        let source = self.source;
        let room = WIDTH.saturating_sub(INDENT * self.depth);
        let mut text = String::new();
        // Content of every open block so far.
        let mut open: Vec<Option<Rule>> = Vec::new();
        for (i, piece) in source.pieces[at..].iter().enumerate() {
            let first = source.first(piece);
            if source.is_commented(piece) || (i > 0 && !first.notes.is_empty()) {
                return None;
            }
            let left = room.checked_sub(columns(&text))?;
            if piece.rule == Rule::close {
                let empty = open.pop()?.is_none();
                // Only an empty block is joined.
                if !empty && first.newlines > 0 {
                    return None;
                }
                text.push_str(if empty { "}" } else { " }" });
                match open.last() {
                    Some(_) => continue,
                    None => {
                        let next = at + i + 1;
                        // The handler of a phase follows the brace of the phase on its line.
                        let handler = source.pieces.get(next);
                        let has_handler = handler.is_some_and(|it| it.rule == Rule::handler_head);
                        let fits = columns(&text) <= room && !has_handler;
                        return fits.then_some((text, next));
                    }
                }
            }
            if i > 0 {
                let inside = open.last_mut()?;
                let gap = match *inside {
                    None => 1,
                    // Captures of a seed may share its line.
                    Some(Rule::seat) if matches!(piece.rule, Rule::seat | Rule::chain) => SEAT_GAP,
                    Some(_) => return None,
                };
                if first.newlines > 0 {
                    return None;
                }
                *inside = Some(piece.rule);
                text.extend(std::iter::repeat_n(' ', gap));
            }
            text.push_str(&statement::short_text(source, piece, left)?);
            if opens(piece.rule) {
                let is_empty = (source.pieces.get(at + i + 1)).is_some_and(|next| {
                    next.rule == Rule::close && source.first(next).notes.is_empty()
                });
                if !is_empty && !is_small(piece.rule) {
                    return None;
                }
                open.push(None);
            }
        }
        None
    }

    /// Lays out consecutive seeds on one line, as far as they fit. Returns the index of the next
    /// piece.
    fn seats(&mut self, at: usize) -> usize {
        let source = self.source;
        if source.is_commented(&source.pieces[at]) {
            self.statement(at);
            return at + 1;
        }
        let mut line = FormattedLine::code(LineKind::Seats, self.depth, "");
        line.cells.clear();
        let mut next = at;
        while let Some(piece) = source.pieces.get(next) {
            let first = source.first(piece);
            let beside = first.newlines == 0 && first.notes.is_empty();
            if piece.rule != Rule::seat || (next > at && !beside) || source.is_commented(piece) {
                break;
            }
            line.cells.push(statement::text(source, piece));
            if next > at && line.width() > WIDTH {
                line.cells.pop();
                break;
            }
            next += 1;
        }
        self.lines.push(line);
        next
    }

    /// Lays out the rows of a layer. If no row has spaces, none are added. Otherwise, one space
    /// separates neighbouring cells.
    fn rows(&mut self, at: usize) -> usize {
        let source = self.source;
        let rows = source.pieces[at..].iter();
        let rows = rows.take_while(|piece| piece.rule == Rule::row);
        let cells = |piece: &TextPiece| statement::text(source, piece);
        let is_close = rows.clone().all(|row| !cells(row).contains([' ', '\t']));
        let mut next = at;
        self.fresh = true;
        for row in rows {
            for number in source.first(row).notes.clone() {
                self.note(number);
            }
            let mut text = String::new();
            for cell in cells(row).chars().filter(|cell| !cell.is_whitespace()) {
                if !text.is_empty() && !is_close {
                    text.push(' ');
                }
                text.push(cell);
            }
            let mut line = FormattedLine::code(LineKind::Plain, self.depth, text);
            line.blank = source.first(row).newlines > 1 && !self.fresh;
            self.fresh = false;
            self.lines.push(line);
            next += 1;
        }
        next
    }

    /// Lays out a line of a scene, and the block that the line opens. Returns the index of the next
    /// piece.
    fn terms(&mut self, at: usize) -> usize {
        if self.source.is_commented(&self.source.pieces[at]) {
            self.statement(at);
            return at + 1;
        }
        let (line, next, opened) = scene::line(self.source, at, self.depth);
        self.lines.push(line);
        self.depth += usize::from(opened);
        next
    }

    fn note(&mut self, number: usize) {
        let note = &self.source.notes[number];
        let blank = note.newlines > 1 && !self.fresh && !self.documented;
        let before = self.lines.len();
        push_note(&mut self.lines, note, self.depth, blank);
        self.fresh &= self.lines.len() == before;
    }
}

/// Adds a comment: at the end of the last line, below the comment there, or on its own line.
pub fn push_note(lines: &mut Vec<FormattedLine>, note: &Note<'_>, depth: usize, blank: bool) {
    let own = match lines.last_mut() {
        Some(last) if note.newlines == 0 && last.note.is_none() => {
            last.note = Some(note.text.to_owned());
            last.note_column = Some(note.column);
            return;
        }
        Some(last) => note.newlines != 1 || last.note_column != Some(note.column),
        None => true,
    };
    let (kind, column) = if own {
        (LineKind::Comment, None)
    } else {
        (LineKind::Continued, Some(note.column))
    };
    let mut line = FormattedLine::code(kind, depth, "");
    line.note = Some(note.text.to_owned());
    line.note_column = column;
    line.blank = blank;
    lines.push(line);
}

/// Returns whether a piece ends in an opening brace.
fn opens(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::assembly_head
            | Rule::phase_head
            | Rule::handler_head
            | Rule::for_head
            | Rule::if_head
            | Rule::pattern_head
            | Rule::seed_head
            | Rule::scene_head
            | Rule::shape_head
            | Rule::layer_head
            | Rule::open
    )
}

/// Returns whether a block with content may be on one line.
fn is_small(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::phase_head | Rule::for_head | Rule::pattern_head | Rule::seed_head
    )
}
