//! The lines of a layout, before their columns are known.

/// One line.
#[derive(Debug)]
pub struct FormattedLine {
    pub kind: LineKind,
    /// Levels of indentation.
    pub depth: usize,
    /// Whether a blank line stands before it.
    pub blank: bool,
    /// Its code; several cells stand in columns.
    pub cells: Vec<String>,
    /// The comment behind the code, or alone.
    pub note: Option<String>,
    /// The column of that comment in the text it comes from.
    pub note_column: Option<usize>,
}

/// What a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineKind {
    /// A statement.
    Plain,
    /// A statement goes on.
    Wrapped,
    /// Opens a block, or closes one.
    Brace,
    /// Seeds, each a cell.
    Seats,
    /// Words of a scene.
    Terms,
    /// A comment of its own, or a `///`.
    Comment,
    /// A comment that goes on under the one behind the code of the line before.
    Continued,
}

impl FormattedLine {
    /// A line with code.
    pub fn code(kind: LineKind, depth: usize, text: impl Into<String>) -> FormattedLine {
        FormattedLine {
            kind,
            depth,
            blank: false,
            cells: vec![text.into()],
            note: None,
            note_column: None,
        }
    }

    /// Columns that its code takes, seeds at their closest.
    pub fn width(&self) -> usize {
        let cells: usize = self.cells.iter().map(|cell| columns(cell)).sum();
        let gaps = SEAT_GAP * self.cells.len().saturating_sub(1);
        super::INDENT * self.depth + cells + gaps
    }
}

/// Columns between two seeds of a line.
pub const SEAT_GAP: usize = 3;

/// Columns of a text: one for each character.
pub fn columns(text: &str) -> usize {
    text.chars().count()
}
