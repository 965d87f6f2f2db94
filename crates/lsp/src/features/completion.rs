//! Completion of keywords, names and faces.
use std::collections::BTreeMap;

use serde_json::{Value, json};
use stochc_compiler::names::NameKind;
use stochc_compiler::scene::BUILT_IN;
use stochc_grammar::{BEGINNINGS, CONTINUATIONS, PartKind, parts};
use stochc_ir::Face;

use super::scene;
use crate::workspace::analysis::Analysis;

/// Completion kinds of the protocol.
const FUNCTION: u32 = 3;
const VARIABLE: u32 = 6;
const CLASS: u32 = 7;
const KEYWORD: u32 = 14;
const ENUM_MEMBER: u32 = 20;

/// Largest number of names in a response.
const MAX_NAMES: usize = 1000;

/// Kinds of names that a place or an argument can contain.
const PLACES: [NameKind; 5] = [
    NameKind::Block,
    NameKind::Instance,
    NameKind::Parameter,
    NameKind::Number,
    NameKind::Counter,
];

/// Returns the words that are allowed at a byte. `line` is the text of its line up to this byte.
pub fn completions(analysis: &Analysis, at: usize, line: &str) -> Value {
    let items = scene::completions(analysis, at).unwrap_or_else(|| words(analysis, line));
    // Makes the client repeat the request for further characters.
    json!({ "isIncomplete": items.len() >= MAX_NAMES, "items": items })
}

/// Words that follow `expect`.
const EVENTS: [&str; 5] = ["captured", "complete", "faster", "mean", "phase"];

/// Returns the words that are allowed at the end of a line, outside of scenes.
fn words(analysis: &Analysis, line: &str) -> Vec<Value> {
    let before = line.trim_end_matches(|c: char| c.is_ascii_alphanumeric() || c == '_');
    let last = parts(before).last().map(|part| part.kind);
    let is_string = last == Some(PartKind::String { is_closed: false });
    if is_string || last == Some(PartKind::Comment) {
        return Vec::new();
    }
    if before.ends_with('.') && !before.ends_with("..") {
        return faces().collect();
    }
    let names = |kinds: &[NameKind]| names(analysis, kinds, &line[before.len()..]);
    let mut words = before.split_whitespace();
    let first = words.clone().next().unwrap_or_default();
    match words.next_back() {
        None => {
            let kinds = [PLACES.as_slice(), &[NameKind::Pattern]].concat();
            let keywords = BEGINNINGS.map(|word| item(word, KEYWORD, "keyword"));
            [names(&kinds), keywords.into()].concat()
        }
        Some("expect") => EVENTS.map(|word| item(word, KEYWORD, "keyword")).into(),
        Some("phase") if first == "expect" => names(&[NameKind::Phase]),
        Some("captured" | "by") if first == "expect" => names(&PLACES),
        // A new name follows.
        Some(
            "aggregate" | "as" | "assembly" | "for" | "let" | "pattern" | "phase" | "scene"
            | "shape",
        ) => Vec::new(),
        Some("in") if first == "for" => names(&PLACES[2..]),
        Some("in" | "from") => {
            let built_in = BUILT_IN.map(|(name, _)| item(name, CLASS, "built-in scene"));
            [names(&[NameKind::Scene]), built_in.into()].concat()
        }
        Some("yields" | "least") => names(&[NameKind::Shape]),
        Some("after" | "release") => names(&PLACES),
        Some(word) if word.ends_with([',', '(', '=']) => {
            names(&PLACES).into_iter().chain(faces()).collect()
        }
        Some(word) if word.ends_with(['>', '[']) => names(&PLACES),
        Some(word) if word.ends_with(['{', '}']) => {
            let kinds = [PLACES.as_slice(), &[NameKind::Pattern]].concat();
            names(&kinds)
        }
        Some(_) => CONTINUATIONS
            .map(|word| item(word, KEYWORD, "keyword"))
            .into(),
    }
}

fn faces() -> impl Iterator<Item = Value> {
    Face::ALL
        .map(|face| item(face.word(), ENUM_MEMBER, "face"))
        .into_iter()
}

/// Returns the program's names of some kinds, each word once. If there are too many, words with the
/// prefix are preferred.
fn names(analysis: &Analysis, kinds: &[NameKind], prefix: &str) -> Vec<Value> {
    let (names, symbols) = (&analysis.names, &analysis.checked.symbols);
    let mut found: BTreeMap<(bool, &str), NameKind> = BTreeMap::new();
    for name in names.all() {
        let kind = names.kind(name.definition);
        if !kinds.contains(&kind) {
            continue;
        }
        let word = symbols.word(names.word(name.definition));
        let key = (!word.starts_with(prefix), word);
        found.entry(key).or_insert(kind);
        if found.len() > MAX_NAMES {
            found.pop_last();
        }
    }
    let shown = found.into_iter().map(|((_, word), kind)| {
        let shown_as = match kind {
            NameKind::Pattern => FUNCTION,
            NameKind::Shape | NameKind::Scene => CLASS,
            _ => VARIABLE,
        };
        item(word, shown_as, kind.noun())
    });
    shown.collect()
}

fn item(label: &str, kind: u32, detail: &str) -> Value {
    json!({ "label": label, "kind": kind, "detail": detail })
}
