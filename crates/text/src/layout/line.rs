//! Lines of aligned cells.

/// Gap between two columns.
pub(super) const GAP: &str = "  ";

/// Returns rows of words as lines, with aligned columns.
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

/// Returns a line of cells of given widths \[characters\]. Words are aligned to the left, numbers
/// to the right.
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
