//! Schema as text, for the language reference and for editors.
use super::{Absent, Range, SchemaEntry, SchemaNumber, SchemaPart};

impl SchemaNumber {
    /// Returns the kind, range and meaning of the parameter: `a length, more than 0: the edge of a
    /// cube`.
    pub fn described(&self) -> String {
        let noun = self.kind.noun.split(',').next().unwrap_or_default();
        let (rule, meaning) = (self.range.rule(), self.meaning);
        match self.range {
            Range::Whole(..) if self.kind.unit.is_empty() => format!("{rule}: {meaning}"),
            _ => format!("{noun}, {rule}: {meaning}"),
        }
    }
}

impl SchemaEntry {
    /// Returns the meaning of the entry and of the values that directly follow its word.
    pub fn described(&self) -> String {
        let values = self.parts.iter().filter_map(|part| match part {
            SchemaPart::Number(number) | SchemaPart::Range { high: number, .. } => {
                Some(number.described())
            }
            _ => None,
        });
        let meaning = (!self.meaning.is_empty()).then(|| self.meaning.to_owned());
        values.chain(meaning).collect::<Vec<_>>().join("; ")
    }

    /// Adds rows of a Markdown table: syntax, meaning, and default. Nested entries follow with a
    /// deeper indentation.
    pub fn rows(&self, depth: usize, out: &mut String) {
        let kinds = self.parts.iter().find_map(|part| match part {
            SchemaPart::OneOf { of, .. } => Some(*of),
            _ => None,
        });
        let absent = match self.absent {
            Absent::Default(it) | Absent::NoTerm(it) | Absent::NoTermWhere(it, _) => it,
            _ if kinds.is_some_and(|kinds| kinds.len() > 1) => "needed, one of these",
            _ => "needed",
        };
        let mut row = |kind: Option<&SchemaEntry>, absent: &str| {
            let descriptions = [Some(self), kind]
                .into_iter()
                .flatten()
                .map(SchemaEntry::described);
            let described: Vec<_> = descriptions.filter(|text| !text.is_empty()).collect();
            let head = self.pattern(kind).join(" ").replace("` `", " ");
            let indent = "&nbsp; ".repeat(depth);
            *out += &format!("| {indent}{head} | {} | {absent} |\n", described.join("; "));
            kind.iter().for_each(|kind| kind.inner_rows(depth, out));
        };
        match kinds {
            None => row(None, absent),
            Some(kinds) => {
                for (i, kind) in kinds.iter().enumerate() {
                    row(Some(kind), if i == 0 { absent } else { "" });
                }
            }
        }
        self.inner_rows(depth, out);
    }

    fn inner_rows(&self, depth: usize, out: &mut String) {
        for part in self.parts {
            match part {
                SchemaPart::Then(entry) => entry.rows(depth + 1, out),
                SchemaPart::Fields(fields, _) => {
                    fields.iter().for_each(|it| it.rows(depth + 1, out))
                }
                _ => {}
            }
        }
    }

    /// Returns the syntax of the entry with the symbols of its values. `kind` is the kind to show,
    /// if the entry has several.
    fn pattern(&self, kind: Option<&SchemaEntry>) -> Vec<String> {
        let mut out = vec![format!("`{}`", self.word)];
        for part in self.parts {
            match part {
                SchemaPart::Number(number) => out.push(number.symbol.to_owned()),
                SchemaPart::Range { low, high } => {
                    out.push(format!("{} `..` {}", low.symbol, high.symbol))
                }
                SchemaPart::OneOf { .. } => {
                    out.extend(kind.iter().flat_map(|kind| kind.pattern(None)))
                }
                SchemaPart::Fields(..) => out.push("`{ ... }`".to_owned()),
                SchemaPart::Then(_) => {}
            }
        }
        out.retain(|text| !text.is_empty());
        out
    }
}
