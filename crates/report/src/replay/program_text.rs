//! Source text of a program, split where the statements of its events begin and end.
use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::{Value, json};
use stochc_results::Source;

/// Location of an event in the source text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventLocation {
    /// Index of the file in the program's sources.
    pub file: usize,
    /// Range of the statement in the file \[bytes\].
    pub bytes: Range<usize>,
    /// Index of the event in the dependency graph. In a loop, many events share one location.
    pub event: u32,
}

/// Returns `[{ file, pieces: [{ lines, events }] }]`: the source texts, split at the ends of the
/// statements. The pieces of a file, joined together, are its text. Omits files without events,
/// except the first file.
pub(super) fn program_text(sources: &[Source], statements: &[EventLocation]) -> Value {
    let files = sources.iter().enumerate().filter_map(|(number, source)| {
        let mut events: BTreeMap<(usize, usize), Vec<u32>> = BTreeMap::new();
        for statement in statements.iter().filter(|it| it.file == number) {
            let Range { start, end } = statement.bytes;
            if start < end && source.text.get(start..end).is_some() {
                events
                    .entry((start, end))
                    .or_default()
                    .push(statement.event);
            }
        }
        if events.is_empty() && number > 0 {
            return None;
        }
        let mut cuts: Vec<usize> = events.keys().flat_map(|&(from, to)| [from, to]).collect();
        cuts.extend([0, source.text.len()]);
        cuts.sort_unstable();
        cuts.dedup();
        let pieces = cuts.windows(2).map(|ends| {
            let inside = events
                .iter()
                .filter(|((from, to), _)| *from <= ends[0] && ends[1] <= *to);
            let events: Vec<u32> = inside.flat_map(|(_, events)| events).copied().collect();
            let text = source.text[ends[0]..ends[1]]
                .replace('\r', "")
                .replace('\t', "    ");
            json!({ "lines": text.split('\n').collect::<Vec<_>>(), "events": events })
        });
        Some(json!({ "file": source.path, "pieces": pieces.collect::<Vec<_>>() }))
    });
    Value::Array(files.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_join_to_the_text() {
        let text = "phase p {\n\tA.up -> B\n}\r\n";
        let source = Source {
            path: "p.sa".into(),
            text: text.into(),
        };
        let statement = |bytes: Range<usize>, event| EventLocation {
            file: 0,
            bytes,
            event,
        };
        let statements = [
            statement(11..20, 4),
            statement(18..20, 5),
            // This range is outside of the text.
            statement(20..99, 6),
        ];
        let value = program_text(&[source], &statements);
        let pieces = value[0]["pieces"].as_array().unwrap();
        let lines = |piece: &Value| -> String {
            let lines: Vec<_> = (piece["lines"].as_array().unwrap().iter())
                .map(|line| line.as_str().unwrap())
                .collect();
            lines.join("\n")
        };
        let whole: String = pieces.iter().map(lines).collect();
        assert_eq!(whole, "phase p {\n    A.up -> B\n}\n");
        let marked: Vec<_> = (pieces.iter())
            .filter(|piece| piece["events"] != json!([]))
            .map(|piece| (lines(piece), piece["events"].clone()))
            .collect();
        assert_eq!(
            marked,
            [
                ("A.up ->".to_owned(), json!([4])),
                (" B".to_owned(), json!([4, 5]))
            ]
        );
    }
}
