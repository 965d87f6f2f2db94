//! Outline of a file.
use gen_lsp_types::{DocumentSymbol, SymbolKind};
use stochc_compiler::{Span, Symbols};
use stochc_grammar::tree::{Item, ItemKind};

use crate::workspace::position::LineIndex;

/// Returns the declarations of a file, with nested ones.
pub fn symbols(items: &[Item], words: &Symbols, lines: &LineIndex<'_>) -> Vec<DocumentSymbol> {
    items
        .iter()
        .filter_map(|item| symbol(item, words, lines))
        .collect()
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
        // Captures and other actions are not declarations, and imports have no names.
        _ => return None,
    };
    let children = symbols(item.body(), words, lines);
    // Loops are included only for their declarations.
    if matches!(item.kind, ItemKind::For(_)) && children.is_empty() {
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
