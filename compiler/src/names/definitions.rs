//! Collects definitions, and merges definitions that prove to be the same.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbol;

use super::declared::DeclaredNames;
use super::{Definition, Keep, NameKind, Names, Occurrence, Use};
use crate::SourceLocation;

/// Definitions in the order of their discovery.
pub struct Definitions {
    keep: Keep,
    kinds: Vec<(NameKind, Symbol)>,
    /// For each definition, an equal definition or itself, as in a union-find structure.
    same: Vec<u32>,
    occurrences: Vec<Occurrence>,
    uses: FxHashMap<Definition, Vec<Use>>,
}

impl Definitions {
    pub fn new(keep: Keep) -> Definitions {
        Definitions {
            keep,
            kinds: Vec::new(),
            same: Vec::new(),
            occurrences: Vec::new(),
            uses: FxHashMap::default(),
        }
    }

    /// Returns whether names of this kind are recorded.
    pub fn stores(&self, kind: NameKind) -> bool {
        self.keep == Keep::All
            || !matches!(kind, NameKind::Block | NameKind::Instance | NameKind::Phase)
    }

    pub fn add(&mut self, kind: NameKind, word: Symbol) -> Definition {
        let definition = Definition(self.kinds.len() as u32);
        self.kinds.push((kind, word));
        self.same.push(definition.0);
        definition
    }

    pub fn kind(&self, definition: Definition) -> NameKind {
        self.kinds[definition.0 as usize].0
    }

    pub fn word(&self, definition: Definition) -> Symbol {
        self.kinds[definition.0 as usize].1
    }

    /// Records a use of a parameter. Ignores other kinds of definitions.
    pub fn used(&mut self, definition: Definition, used: Use) {
        if self.kind(definition) == NameKind::Parameter {
            self.uses.entry(definition).or_default().push(used);
        }
    }

    pub fn occur(&mut self, definition: Definition, location: SourceLocation, declares: bool) {
        if !self.stores(self.kind(definition)) {
            return;
        }
        self.occurrences.push(Occurrence {
            location,
            definition,
            declares,
        });
    }

    /// Merges these definitions into one. Returns `None` if there are none.
    pub fn unite(
        &mut self,
        definitions: impl IntoIterator<Item = Definition>,
    ) -> Option<Definition> {
        let mut definitions = definitions.into_iter();
        let first = self.root(definitions.next()?);
        for other in definitions {
            let root = self.root(other);
            // The first of them stays, so that the order of files decides.
            self.same[root.0.max(first.0) as usize] = root.0.min(first.0);
        }
        Some(self.root(first))
    }

    fn root(&mut self, definition: Definition) -> Definition {
        let mut at = definition.0;
        while self.same[at as usize] != at {
            let next = self.same[at as usize];
            self.same[at as usize] = self.same[next as usize];
            at = next;
        }
        Definition(at)
    }

    /// Returns all names, sorted by file and location.
    pub fn finish(mut self, declared: DeclaredNames) -> Names {
        let mut occurrences = std::mem::take(&mut self.occurrences);
        for occurrence in &mut occurrences {
            occurrence.definition = self.root(occurrence.definition);
        }
        occurrences
            .sort_by_key(|occurrence| (occurrence.location.file, occurrence.location.span.start));
        occurrences
            .dedup_by_key(|occurrence| (occurrence.location.file, occurrence.location.span.start));
        let requested = (occurrences.iter()).filter(|it| self.kind(it.definition).is_asked_for());
        let definitions =
            requested.map(|it| ((it.location.file, it.location.span.start), it.definition));
        let definitions = definitions.collect();
        let mut uses = std::mem::take(&mut self.uses);
        for used in uses.values_mut().flatten() {
            if let Use::Argument(pattern, _) = used {
                *pattern = self.root(*pattern);
            }
        }
        Names {
            definitions,
            occurrences,
            kinds: self.kinds,
            uses,
            declared,
        }
    }
}

/// Definitions of numbers, counters and parameters, for each block of statements.
#[derive(Default)]
pub struct Bindings {
    words: FxHashMap<Symbol, Vec<Definition>>,
    order: Vec<Symbol>,
}

impl Bindings {
    pub fn mark(&self) -> usize {
        self.order.len()
    }

    pub fn restore(&mut self, mark: usize) {
        for word in self.order.drain(mark..) {
            if let Some(definitions) = self.words.get_mut(&word) {
                definitions.pop();
            }
        }
    }

    pub fn define(&mut self, word: Symbol, definition: Definition) {
        self.words.entry(word).or_default().push(definition);
        self.order.push(word);
    }

    pub fn get(&self, word: Symbol) -> Option<Definition> {
        self.words.get(&word)?.last().copied()
    }
}
