//! Warnings about unused declarations of a program's file.
//!
//! Files without an assembly or aggregate are not judged, because other files may import them.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::{Item, ItemKind, Name};
use stochc_grammar::{Span, Symbols};

use crate::diagnostic::{Code, Diagnostic, Fix, removal, report};
use crate::names::{Definition, Names};
use crate::scene::DEFAULT;
use crate::sources::load::Module;
use crate::{FileId, SourceLocation, Sources};

struct Declared<'a> {
    item: &'a Item,
    name: Name,
    code: Code,
    /// Whether the declaration is inside another item, so that no other file can use it.
    is_local: bool,
}

/// Warns of unused declarations in the last module, the program's own file. Ignores a file without
/// a program.
pub fn check(
    modules: &[Module],
    names: &Names,
    sources: &Sources,
    symbols: &Symbols,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let Some(own) = modules.last() else { return };
    let items = &own.tree.items;
    if !items.iter().any(|item| scene_of(item).is_some()) {
        return;
    }
    let mut declared = Vec::new();
    collect(items, false, &mut declared);
    let in_default = items.iter().any(|item| scene_of(item) == Some(None));
    declared.retain(|it| {
        let word = symbols.word(it.name.symbol);
        let is_default = it.code == Code::UnusedScene && word == DEFAULT && in_default;
        !word.starts_with('_') && !is_default
    });
    let used = used(&declared, own.file, names);
    for it in &declared {
        let definition = names
            .at(own.file, it.name.span.start)
            .map(|name| name.definition);
        if definition.is_some_and(|definition| !used.contains(&definition)) {
            report(diagnostics, it.unused(own.file, sources, symbols));
        }
    }
}

/// Returns the scene that a program names: `Some(None)` if it names none. Returns `None` for items
/// that are not programs.
fn scene_of(item: &Item) -> Option<Option<Name>> {
    match &item.kind {
        ItemKind::Assembly(assembly) => Some(assembly.scene),
        ItemKind::Aggregate(aggregate) => Some(aggregate.scene),
        _ => None,
    }
}

/// Collects the declarations among these items and in their bodies. The parser limits the depth of
/// bodies.
fn collect<'a>(items: &'a [Item], is_local: bool, declared: &mut Vec<Declared<'a>>) {
    for item in items {
        let named = match &item.kind {
            ItemKind::Let(let_) => Some((let_.name, Code::UnusedLet)),
            ItemKind::Pattern(pattern) => Some((pattern.name, Code::UnusedPattern)),
            ItemKind::Shape(shape) => Some((shape.name, Code::UnusedShape)),
            ItemKind::Scene(scene) => Some((scene.name, Code::UnusedScene)),
            _ => None,
        };
        declared.extend(named.map(|(name, code)| Declared {
            item,
            name,
            code,
            is_local,
        }));
        collect(item.body(), true, declared);
    }
}

/// Returns the definitions that are used outside their own declarations.
fn used(declared: &[Declared<'_>], file: FileId, names: &Names) -> FxHashSet<Definition> {
    // A pattern that only contains itself is not used.
    let mut own: FxHashMap<Definition, Vec<Span>> = FxHashMap::default();
    for it in declared {
        if let Some(name) = names.at(file, it.name.span.start) {
            own.entry(name.definition).or_default().push(it.item.span);
        }
    }
    let is_elsewhere = |location: SourceLocation, spans: &[Span]| {
        let at = location.span.start;
        location.file != file
            || !spans
                .iter()
                .any(|span| (span.start..span.end).contains(&at))
    };
    (names.all().iter())
        .filter(|name| !name.declares)
        .filter(|name| {
            own.get(&name.definition)
                .is_some_and(|spans| is_elsewhere(name.location, spans))
        })
        .map(|name| name.definition)
        .collect()
}

impl Declared<'_> {
    fn unused(&self, file: FileId, sources: &Sources, symbols: &Symbols) -> Diagnostic {
        let word = symbols.word(self.name.symbol);
        let keep = format!("rename it to `_{word}`");
        let (title, label, help) = match self.code {
            Code::UnusedLet => (
                format!("number `{word}` is never used"),
                "no statement of this file uses it",
                format!("remove it, or {keep}"),
            ),
            Code::UnusedPattern => (
                format!("pattern `{word}` is never used"),
                "the program has no instance of it",
                format!("write an instance of it, remove it, or {keep}"),
            ),
            Code::UnusedShape => (
                format!("shape `{word}` is never checked"),
                "no phase yields it",
                format!("write `yields {word}` in the phase that completes it, or {keep}"),
            ),
            _ => (
                format!("scene `{word}` is never used"),
                "no assembly, aggregate or scene names it",
                format!("write `assembly NAME in {word}`, or {keep}"),
            ),
        };
        let location = |span| SourceLocation { file, span };
        let mut diagnostic = Diagnostic::new(self.code, title)
            .label(location(self.name.span), label)
            .help(help);
        // Otherwise its documentation would belong to the next item.
        if self.item.docs.0.is_none() {
            let removed = removal(sources, location(self.item.span));
            let is_certain = self.code == Code::UnusedLet && self.is_local;
            let title = format!("remove {}", self.item.noun().replacen("a ", "the ", 1));
            diagnostic.fix = Some(Fix::remove(removed, title).unsafe_if(!is_certain));
        }
        diagnostic
    }
}
