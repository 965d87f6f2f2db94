//! Tables of comma-separated values (RFC 4180).
use std::borrow::Cow;

use csv::{Terminator, Writer, WriterBuilder};

/// Table in memory that grows by rows.
pub struct CsvTable(Writer<Vec<u8>>);

impl CsvTable {
    /// Returns a table with a header and no rows.
    pub fn new(columns: impl IntoIterator<Item = impl AsRef<str>>) -> CsvTable {
        let mut table = CsvTable::part();
        table.row(columns);
        table
    }

    /// Returns an empty continuation of a table, without a header.
    pub fn part() -> CsvTable {
        let mut builder = WriterBuilder::new();
        CsvTable(builder.terminator(Terminator::CRLF).from_writer(Vec::new()))
    }

    /// Adds a row with one cell per column. [`original`] recovers the text of a cell.
    ///
    /// # Panics
    ///
    /// If the number of cells differs from the number of columns.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl AsRef<str>>) {
        for cell in cells {
            let cell = inert(cell.as_ref());
            self.0
                .write_field(&*cell)
                .expect("writing to memory cannot fail");
        }
        let end = self.0.write_record(None::<&[u8]>);
        end.expect("every row has a cell for each column");
    }

    /// Returns the text of the file.
    pub fn finish(self) -> String {
        let bytes = self.0.into_inner().expect("writing to memory cannot fail");
        String::from_utf8(bytes).expect("cells are text")
    }
}

/// Makes a cell safe for spreadsheets: text that would be a formula gets an apostrophe in front.
fn inert(cell: &str) -> Cow<'_, str> {
    if is_computed(cell) && cell.parse::<f64>().is_err() {
        format!("'{cell}").into()
    } else {
        cell.into()
    }
}

/// Recovers the text of a cell of a [`CsvTable`].
pub fn original(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(rest) if is_computed(rest) => rest,
        _ => cell,
    }
}

/// Returns whether spreadsheets treat a cell as a formula, possibly after apostrophes.
fn is_computed(cell: &str) -> bool {
    let bare = cell.trim_start_matches('\'');
    bare.starts_with(['=', '+', '-', '@', '\t', '\r', '\n'])
}

#[cfg(test)]
mod tests {
    use super::{CsvTable, original};

    #[test]
    fn texts_are_never_formulas() {
        let mut table = CsvTable::new(["=a", "b"]);
        for text in ["=1+1", "+cmd|' /C calc'!A0", "-a", "@b", "\tc", "\rd"] {
            table.row([text, "'=e"]);
        }
        table.row(["-1.5e-3", "it's"]);
        table.row(["+4", "-inf"]);
        let text = table.finish();
        assert!(text.contains("-1.5e-3,it's\r\n+4,-inf\r\n"), "{text}");
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.as_bytes());
        let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
        for cell in rows.iter().flatten() {
            let is_number = cell.parse::<f64>().is_ok();
            assert!(
                is_number || !cell.starts_with(['=', '+', '-', '@', '\t', '\r']),
                "{cell:?}"
            );
        }
        assert_eq!(original(&rows[0][0]), "=a");
        assert_eq!(original(&rows[1][0]), "=1+1");
        assert_eq!(original(&rows[1][1]), "'=e");
        assert_eq!(original(&rows[7][1]), "it's");
    }

    #[test]
    fn a_field_may_contain_anything() {
        let mut table = CsvTable::new(["plain", "a,\"b\"\n"]);
        table.row(["", "ä"]);
        assert_eq!(table.finish(), "plain,\"a,\"\"b\"\"\n\"\r\n,ä\r\n");
    }
}
