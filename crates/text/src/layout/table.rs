//! Aligned columns of plain text.
use crate::visible;

use super::line::{GAP, chars, line};

/// Largest width of one line of a header cell \[characters\].
const HEADER: usize = 22;

/// Table of aligned columns. Columns that exceed the width of a line continue below, after a
/// repeated label column.
///
/// Table libraries cut cells instead, or leave line breaks to the terminal.
#[derive(Clone, Debug, Default)]
pub struct TextTable {
    /// Header of the label column, possibly empty.
    pub label: String,
    /// Label column, repeated before the columns that continue below.
    pub labels: Vec<String>,
    /// Further columns.
    pub columns: Vec<TextColumn>,
    /// Whether each row is red. Rows beyond the end of this list are not red.
    pub red: Vec<bool>,
}

/// A column of a [`TextTable`].
#[derive(Clone, Debug)]
pub struct TextColumn {
    /// Header. Long headers are broken.
    pub header: String,
    /// One cell per label.
    pub cells: Vec<String>,
    /// Whether the cells are words, aligned to the left. Numbers are aligned to the right.
    pub is_words: bool,
}

impl TextColumn {
    /// Creates a column of numbers.
    pub fn figures(header: impl Into<String>, cells: Vec<String>) -> TextColumn {
        TextColumn {
            header: header.into(),
            cells,
            is_words: false,
        }
    }

    /// Creates a column of words.
    pub fn words(header: impl Into<String>, cells: Vec<String>) -> TextColumn {
        TextColumn {
            is_words: true,
            ..TextColumn::figures(header, cells)
        }
    }
}

/// A column with its layout.
struct Placed<'a> {
    column: &'a TextColumn,
    header: Vec<String>,
    width: usize,
}

impl TextTable {
    /// Returns the text in lines of `width` characters, or in longer lines if a single column is
    /// wider. With `colour`, red rows are coloured.
    ///
    /// Invisible characters in names become visible.
    pub fn text(&self, width: usize, colour: bool) -> String {
        self.visible().laid_out(width, colour)
    }

    fn visible(&self) -> TextTable {
        let all = |texts: &[String]| texts.iter().map(|text| visible(text)).collect();
        let column = |column: &TextColumn| TextColumn {
            header: visible(&column.header),
            cells: all(&column.cells),
            is_words: column.is_words,
        };
        TextTable {
            label: visible(&self.label),
            labels: all(&self.labels),
            columns: self.columns.iter().map(column).collect(),
            red: self.red.clone(),
        }
    }

    fn laid_out(&self, width: usize, colour: bool) -> String {
        let labels = self.labels.iter().chain([&self.label]);
        let label_width = labels.map(|label| chars(label)).max().unwrap_or(0);
        let mut blocks = Vec::new();
        let mut block: Vec<Placed> = Vec::new();
        let mut used = label_width;
        for column in &self.columns {
            let header = broken(&column.header);
            let texts = header.iter().chain(&column.cells);
            let column_width = texts.map(|text| chars(text)).max().unwrap_or(0);
            if !block.is_empty() && used + GAP.len() + column_width > width {
                blocks.push(self.block(&block, label_width, colour));
                block.clear();
                used = label_width;
            }
            used += GAP.len() + column_width;
            block.push(Placed {
                column,
                header,
                width: column_width,
            });
        }
        blocks.push(self.block(&block, label_width, colour));
        blocks.join("\n")
    }

    fn block(&self, columns: &[Placed], label_width: usize, colour: bool) -> String {
        let row = |label: &str, cells: &[&str]| {
            let placed = cells.iter().zip(columns);
            let cells = placed.map(|(cell, it)| (*cell, it.width, it.column.is_words));
            line([(label, label_width, true)].into_iter().chain(cells))
        };
        let height = columns.iter().map(|c| c.header.len()).max().unwrap_or(0);
        let mut lines = Vec::new();
        for number in 0..height {
            // Short headers stand directly above the rule.
            let cell = |c: &Placed| (number + c.header.len()).checked_sub(height);
            let cells: Vec<String> = columns
                .iter()
                .map(|c| cell(c).map_or(String::new(), |i| c.header[i].clone()))
                .collect();
            let label = if number + 1 == height {
                &*self.label
            } else {
                ""
            };
            lines.push(row(
                label,
                &cells.iter().map(String::as_str).collect::<Vec<_>>(),
            ));
        }
        // Remarks have no header and no rule.
        let rule = |c: &Placed| match &*c.column.header {
            "" => String::new(),
            _ => "─".repeat(c.width),
        };
        let rules: Vec<String> = columns.iter().map(rule).collect();
        let rules: Vec<&str> = rules.iter().map(String::as_str).collect();
        lines.push(row(&"─".repeat(label_width), &rules));
        for (i, label) in self.labels.iter().enumerate() {
            let cells: Vec<&str> = columns.iter().map(|c| &*c.column.cells[i]).collect();
            // This row has cells only in another block.
            if cells.iter().all(|cell| cell.is_empty()) {
                continue;
            }
            let line = row(label, &cells);
            let is_red = colour && self.red.get(i) == Some(&true);
            lines.push(if is_red {
                format!("\u{1b}[31m{line}\u{1b}[0m")
            } else {
                line
            });
        }
        lines.iter().map(|line| format!("{line}\n")).collect()
    }
}

/// Breaks a header into lines, after hyphens if possible.
fn broken(header: &str) -> Vec<String> {
    let letters: Vec<char> = header.chars().collect();
    let mut rest = &letters[..];
    let mut lines = Vec::new();
    while rest.len() > HEADER {
        let joint = |letter: &char| "_- ./".contains(*letter);
        let end = rest[..HEADER]
            .iter()
            .rposition(joint)
            .map_or(HEADER, |i| i + 1);
        lines.push(rest[..end].iter().collect());
        rest = &rest[end..];
    }
    lines.push(rest.iter().collect());
    lines
}
