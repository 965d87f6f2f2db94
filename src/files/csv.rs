//! Tables of comma-separated values (RFC 4180).

/// A table that grows row by row.
pub(crate) struct Table(String);

impl Table {
    /// A table without rows.
    pub fn new(columns: impl IntoIterator<Item = impl Into<String>>) -> Table {
        let mut table = Table(String::new());
        table.row(columns.into_iter().map(Into::into));
        table
    }

    /// Adds a row, which has to have a cell for each column.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        let cells: Vec<String> = cells.into_iter().map(|cell| field(&cell)).collect();
        self.0 += &cells.join(",");
        self.0 += "\r\n";
    }

    /// The text of the file.
    pub fn finish(self) -> String {
        self.0
    }
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_field_may_hold_anything() {
        assert_eq!(super::field("plain"), "plain");
        assert_eq!(super::field("a,\"b\"\n"), "\"a,\"\"b\"\"\n\"");
    }
}
