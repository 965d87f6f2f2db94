//! Tables of comma-separated values (RFC 4180).
use csv::{Terminator, Writer, WriterBuilder};

/// A table that grows row by row in memory.
pub struct Table(Writer<Vec<u8>>);

impl Table {
    /// A table without rows.
    pub fn new(columns: impl IntoIterator<Item = impl AsRef<[u8]>>) -> Table {
        let writer = WriterBuilder::new()
            .terminator(Terminator::CRLF)
            .from_writer(Vec::new());
        let mut table = Table(writer);
        table.row(columns);
        table
    }

    /// Adds a row, which has to have a cell for each column.
    ///
    /// # Panics
    /// Where it has not.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl AsRef<[u8]>>) {
        self.0
            .write_record(cells)
            .expect("every row has a cell for each column");
    }

    /// The text of the file.
    pub fn finish(self) -> String {
        let bytes = self.0.into_inner().expect("memory takes everything");
        String::from_utf8(bytes).expect("cells are text")
    }
}

#[cfg(test)]
mod tests {
    use super::Table;

    #[test]
    fn a_field_may_hold_anything() {
        let mut table = Table::new(["plain", "a,\"b\"\n"]);
        table.row(["", "ä"]);
        assert_eq!(table.finish(), "plain,\"a,\"\"b\"\"\n\"\r\n,ä\r\n");
    }
}
