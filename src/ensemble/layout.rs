//! Aligned columns of plain text.

/// A header cell is broken into lines of this many characters.
const HEADER: usize = 22;

/// Between words that belong together; no name has it.
const TIE: char = '~';

/// Between two columns.
const GAP: &str = "   ";

/// Columns that are put side by side until a line is full, and then below.
pub(crate) struct Layout {
    /// Of the column on the left, which every block of columns repeats.
    pub labels: Vec<String>,
    /// Each with its header and one cell for each label.
    pub columns: Vec<(String, Vec<String>)>,
}

impl Layout {
    /// The text, in lines of `width` characters or as many as one column needs.
    pub fn text(&self, width: usize) -> String {
        let label_width = self.labels.iter().map(|l| chars(l)).max().unwrap_or(0);
        let mut blocks = Vec::new();
        let mut block: Vec<Column> = Vec::new();
        let mut used = label_width;
        for (header, cells) in &self.columns {
            let column = Column::new(header, cells);
            if !block.is_empty() && used + GAP.len() + column.width > width {
                blocks.push(self.block(&block, label_width));
                block.clear();
                used = label_width;
            }
            used += GAP.len() + column.width;
            block.push(column);
        }
        blocks.push(self.block(&block, label_width));
        blocks.join("\n")
    }

    fn block(&self, columns: &[Column], label_width: usize) -> String {
        let height = columns.iter().map(|c| c.header.len()).max().unwrap_or(0);
        let mut text = String::new();
        let mut line = |label: &str, cells: &[&str]| {
            let mut line = format!("{label:label_width$}");
            for (cell, column) in cells.iter().zip(columns) {
                line += &format!("{GAP}{cell:>width$}", width = column.width);
            }
            text += line.trim_end();
            text.push('\n');
        };
        for row in 0..height {
            // Short headers stand on the line above the rule.
            let cell = |c: &Column| (row + c.header.len()).checked_sub(height);
            let cells: Vec<String> = columns
                .iter()
                .map(|c| cell(c).map_or(String::new(), |i| c.header[i].clone()))
                .collect();
            line("", &cells.iter().map(String::as_str).collect::<Vec<_>>());
        }
        let rules: Vec<String> = columns.iter().map(|c| "─".repeat(c.width)).collect();
        let rules: Vec<&str> = rules.iter().map(String::as_str).collect();
        line(&"─".repeat(label_width), &rules);
        for (i, label) in self.labels.iter().enumerate() {
            let cells: Vec<&str> = columns.iter().map(|c| c.cells[i].as_str()).collect();
            // A row for others, which stand in another block.
            if cells.iter().any(|cell| !cell.is_empty()) {
                line(label, &cells);
            }
        }
        text
    }
}

struct Column<'a> {
    header: Vec<String>,
    cells: &'a [String],
    width: usize,
}

impl<'a> Column<'a> {
    fn new(header: &str, cells: &'a [String]) -> Column<'a> {
        let header = broken(header);
        let width = header.iter().chain(cells).map(|text| chars(text)).max();
        Column {
            width: width.unwrap_or(0),
            header,
            cells,
        }
    }
}

/// A header in lines, broken behind a sign that joins words where there is one.
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

/// A sentence in lines of `width` characters, all but the first of them indented; it is not broken
/// at `~`, which becomes a space.
pub(crate) fn paragraph(text: &str, width: usize) -> String {
    let mut out = String::new();
    let mut used = 0;
    for word in text.split(' ') {
        let fits = used + 1 + chars(word) <= width;
        let gap = match (used, fits) {
            (0, _) => "",
            (_, true) => " ",
            (_, false) => {
                used = 0;
                "\n  "
            }
        };
        out += gap;
        out += &word.replace(TIE, " ");
        used += gap.trim_start_matches('\n').len() + chars(word);
    }
    out.push('\n');
    out
}

fn chars(text: &str) -> usize {
    text.chars().count()
}
