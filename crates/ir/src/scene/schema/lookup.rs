//! Parameters and keywords of entries.
use super::clauses::CLAUSES;
use super::entry::{SchemaEntry, SchemaPart};
use super::number::SchemaNumber;

/// Returns all parameters of an entry, in the order of the language reference.
pub fn numbers(entry: &SchemaEntry) -> Vec<&'static SchemaNumber> {
    let mut out: Vec<&'static SchemaNumber> = Vec::new();
    for part in entry.parts {
        match part {
            SchemaPart::Number(number) => out.push(number),
            SchemaPart::Range { low, high } => out.extend([high, low]),
            SchemaPart::OneOf { of: more, .. } | SchemaPart::Fields(more, _) => {
                out.extend(more.iter().flat_map(numbers));
            }
            SchemaPart::Then(entry) => out.extend(numbers(entry)),
        }
    }
    out
}

/// Returns whether a word is a keyword in scenes.
pub fn is_word(word: &str) -> bool {
    fn has(entry: &SchemaEntry, word: &str) -> bool {
        entry.word == word || entry.words().any(|entry| has(entry, word))
    }
    CLAUSES.iter().any(|clause| has(clause, word))
}
