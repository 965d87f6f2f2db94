//! Lines of cells that stand below each other.

/// Between two columns.
pub(super) const GAP: &str = "  ";

/// Rows of words as lines, in columns as wide as their widest cells.
pub fn aligned<const COLUMNS: usize>(rows: &[[String; COLUMNS]]) -> Vec<String> {
    let widths: [usize; COLUMNS] = std::array::from_fn(|column| {
        let cells = rows.iter().map(|row| chars(&row[column]));
        cells.max().unwrap_or(0)
    });
    let cells = |row: &[String; COLUMNS]| line(row.iter().zip(widths).map(words));
    rows.iter().map(cells).collect()
}

fn words((cell, width): (&String, usize)) -> (&str, usize, bool) {
    (cell, width, true)
}

/// A line of cells, each in so many characters: words begin on the left, figures end on the right.
pub(super) fn line<'a>(cells: impl Iterator<Item = (&'a str, usize, bool)>) -> String {
    let padded = cells.map(|(cell, width, is_words)| {
        if is_words {
            format!("{cell:width$}")
        } else {
            format!("{cell:>width$}")
        }
    });
    let padded: Vec<String> = padded.collect();
    padded.join(GAP).trim_end().to_owned()
}

pub(super) fn chars(text: &str) -> usize {
    text.chars().count()
}
