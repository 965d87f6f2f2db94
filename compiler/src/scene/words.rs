//! Meanings and alternatives of the words of a scene, for editors.
use stochc_grammar::tree::{SceneDeclaration, Term};
use stochc_grammar::{Span, Symbols};
use stochc_ir::scene::schema::{CLAUSES, SchemaEntry, SchemaPart};

/// Words around a position in a scene, and the words that are valid at it.
#[derive(Debug)]
pub struct WordContext {
    /// Word at the position.
    pub word: Option<Span>,
    /// Entries from the clause to the word. Empty if the word is unknown.
    pub path: Vec<&'static SchemaEntry>,
    /// Words that are valid at the position.
    pub next: Vec<&'static SchemaEntry>,
}

impl WordContext {
    /// Returns the words around the byte `at` of a scene.
    pub fn at(scene: &SceneDeclaration, symbols: &Symbols, at: u32) -> WordContext {
        within(&scene.terms, symbols, &[], &CLAUSES, at)
    }
}

/// Returns the words around a byte in the braces of `outer`. `known` contains the valid entries
/// there.
fn within(
    terms: &[Term],
    symbols: &Symbols,
    outer: &[&'static SchemaEntry],
    known: &'static [SchemaEntry],
    at: u32,
) -> WordContext {
    let mut path = outer.to_vec();
    let mut present: Vec<&str> = Vec::new();
    let mut word = None;
    let mut before = None;
    for term in terms {
        match term {
            Term::Block(inner, span) if span.start < at && at < span.end => {
                let fields = path.iter().rev().find_map(|entry| entry.fields());
                return within(inner, symbols, &path, fields.map_or(&[], |it| it.0), at);
            }
            Term::Word(name) if name.span.start <= at && at <= name.span.end => {
                before = Some(path.clone());
                word = Some(name.span);
                follow(&mut path, outer.len(), known, symbols.word(name.symbol));
            }
            Term::Word(name) => {
                present.push(symbols.word(name.symbol));
                if name.span.end < at {
                    follow(&mut path, outer.len(), known, symbols.word(name.symbol));
                }
            }
            _ => {}
        }
    }
    let own = &before.as_deref().unwrap_or(&path)[outer.len()..];
    let kinds = own
        .last()
        .map(|entry| choices(entry, true))
        .unwrap_or_default();
    let next = if !kinds.is_empty() {
        kinds
    } else {
        let known = known.iter().filter(|entry| !present.contains(&entry.word));
        let is_new =
            |entry: &&SchemaEntry| !own.iter().any(|present| std::ptr::eq(*present, *entry));
        let further = own.iter().flat_map(|entry| choices(entry, false));
        further.filter(is_new).chain(known).collect()
    };
    WordContext { word, path, next }
}

/// Appends an entry to the path if the word is the keyword of an entry.
fn follow(
    path: &mut Vec<&'static SchemaEntry>,
    outer: usize,
    known: &'static [SchemaEntry],
    word: &str,
) {
    let further = path[outer..].iter().rev().flat_map(|entry| {
        let kinds = choices(entry, true).into_iter();
        kinds.chain(choices(entry, false))
    });
    match further.into_iter().find(|entry| entry.word == word) {
        Some(entry) => path.push(entry),
        None => {
            path.truncate(outer);
            path.extend(known.iter().find(|entry| entry.word == word));
        }
    }
}

/// If `of_kind` is true, returns the words that select the kind of an entry. Otherwise returns the
/// words after its values.
fn choices(entry: &'static SchemaEntry, of_kind: bool) -> Vec<&'static SchemaEntry> {
    let parts = entry.parts.iter().flat_map(|part| match part {
        SchemaPart::OneOf { of, .. } if of_kind => *of,
        SchemaPart::Then(entry) if !of_kind => std::slice::from_ref(*entry),
        _ => &[],
    });
    parts.collect()
}
