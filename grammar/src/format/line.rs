//! Formatted lines before their columns are aligned.

#[derive(Debug)]
pub struct FormattedLine {
    pub kind: LineKind,
    /// Indentation level.
    pub depth: usize,
    /// Whether a blank line precedes this line.
    pub blank: bool,
    /// Code of the line, in parts that are aligned in columns.
    pub cells: Vec<String>,
    /// Comment at the end of the line, or the only content of the line.
    pub note: Option<String>,
    /// Column of the comment in the source.
    pub note_column: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineKind {
    /// A line of any other kind, such as a statement.
    Plain,
    /// The continuation of a statement.
    Wrapped,
    /// The start or end of a block.
    Brace,
    /// A line of seeds. Each seed is one element of [`FormattedLine::cells`].
    Seats,
    /// A line of a scene, whose words are aligned in columns.
    Terms,
    /// A separate comment or a `///` comment.
    Comment,
    /// The next line of a comment that follows code, aligned with the first line of the comment.
    Continued,
}

impl FormattedLine {
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

    /// Returns the width of the code without alignment \[columns\].
    pub fn width(&self) -> usize {
        let cells: usize = self.cells.iter().map(|cell| columns(cell)).sum();
        let gaps = SEAT_GAP * self.cells.len().saturating_sub(1);
        super::INDENT * self.depth + cells + gaps
    }
}

/// Space between two seeds of a line.
pub const SEAT_GAP: usize = 3;

/// Returns the width of a text in characters.
pub fn columns(text: &str) -> usize {
    text.chars().count()
}
