//! Outline of a file, and symbols of the workspace.
use std::collections::BTreeSet;

use gen_lsp_types::{DocumentSymbol, SymbolKind};
use serde_json::{Value, json};
use stochc_compiler::{Span, Symbols};
use stochc_grammar::tree::{Item, ItemKind};

use crate::workspace::analysis::Analysis;
use crate::workspace::documents::Documents;
use crate::workspace::position::LineIndex;

/// Largest number of symbols in a response about the workspace.
const MAX_FOUND: usize = 1000;

/// Returns the declarations of a file, with nested ones.
pub fn symbols(items: &[Item], words: &Symbols, lines: &LineIndex<'_>) -> Vec<DocumentSymbol> {
    items
        .iter()
        .filter_map(|item| symbol(item, words, lines))
        .collect()
}

/// Returns the declarations in some programs and their imports. A name must contain the characters
/// of the query, in their order and in either case.
pub fn in_workspace(all: &[&Analysis], query: &str, documents: &Documents) -> Vec<Value> {
    let query: Vec<char> = query.to_lowercase().chars().collect();
    let mut files = BTreeSet::new();
    let mut found = Vec::new();
    for analysis in all {
        for (file, tree) in analysis.checked.trees() {
            if !files.insert(analysis.path(file)) {
                continue;
            }
            let uri = documents.uri(analysis.path(file));
            let outline = symbols(
                &tree.items,
                &analysis.checked.symbols,
                &analysis.lines(file),
            );
            add(outline, None, &query, &uri, &mut found);
        }
    }
    found
}

fn add(
    symbols: Vec<DocumentSymbol>,
    container: Option<&str>,
    query: &[char],
    uri: &str,
    found: &mut Vec<Value>,
) {
    for symbol in symbols {
        if matches(&symbol.name, query) && found.len() < MAX_FOUND {
            found.push(json!({
                "name": symbol.name,
                "kind": symbol.kind,
                "location": { "uri": uri, "range": symbol.selection_range },
                "containerName": container,
            }));
        }
        let children = symbol.children.unwrap_or_default();
        add(children, Some(&symbol.name), query, uri, found);
    }
}

fn matches(name: &str, query: &[char]) -> bool {
    let mut rest = query.iter().peekable();
    for character in name.chars().flat_map(char::to_lowercase) {
        rest.next_if(|&&wanted| wanted == character);
    }
    rest.peek().is_none()
}

fn symbol(item: &Item, words: &Symbols, lines: &LineIndex<'_>) -> Option<DocumentSymbol> {
    let word = |name: &stochc_grammar::tree::Name| (words.word(name.symbol).to_owned(), name.span);
    let ((name, span), kind, detail) = match &item.kind {
        ItemKind::Assembly(it) => (word(&it.name), SymbolKind::Module, "assembly"),
        ItemKind::Aggregate(it) => (word(&it.name), SymbolKind::Module, "aggregate"),
        ItemKind::Pattern(it) => (word(&it.name), SymbolKind::Function, "pattern"),
        ItemKind::Shape(it) => (word(&it.name), SymbolKind::Object, "shape"),
        ItemKind::Scene(it) => (word(&it.name), SymbolKind::Namespace, "scene"),
        ItemKind::Let(it) => (word(&it.name), SymbolKind::Constant, "let"),
        ItemKind::Phase(it) => {
            let name = it.name.path.first()?;
            (word(&name.name), SymbolKind::Method, "phase")
        }
        ItemKind::Seed(_) => {
            let start = item.span.start;
            let span = Span::new(start, start + "seed".len() as u32);
            (("seed plate".to_owned(), span), SymbolKind::Array, "")
        }
        ItemKind::Seat(it) => {
            let name = it.place.path.first()?;
            (word(&name.name), SymbolKind::Field, "seed")
        }
        ItemKind::For(it) => (word(&it.counter), SymbolKind::Variable, "for"),
        ItemKind::If(it) => {
            let keyword = if it.is_else { "else" } else { "if" };
            let start = item.span.start;
            let span = Span::new(start, start + keyword.len() as u32);
            ((keyword.to_owned(), span), SymbolKind::Boolean, "")
        }
        // Captures and other actions are not declarations, and imports have no names.
        _ => return None,
    };
    let children = symbols(item.body(), words, lines);
    // Loops and conditions are included only for their declarations.
    if item.is_transparent() && children.is_empty() {
        return None;
    }
    #[allow(deprecated, reason = "the protocol has a deprecated field")]
    Some(DocumentSymbol {
        name,
        detail: (!detail.is_empty()).then(|| detail.to_owned()),
        kind,
        tags: None,
        deprecated: None,
        range: lines.range(item.span),
        selection_range: lines.range(span),
        children: (!children.is_empty()).then_some(children),
    })
}
