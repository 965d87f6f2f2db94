//! The things that words stand for, and those that turn out to be one.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbol;

use super::{Keep, NameKind, Names, Occurrence, Thing, Use};
use crate::Site;

/// Things, found one after the other.
pub struct Things {
    keep: Keep,
    kinds: Vec<(NameKind, Symbol)>,
    /// For every thing, another one that it is the same as, or itself.
    same: Vec<u32>,
    occurrences: Vec<Occurrence>,
    uses: FxHashMap<Thing, Vec<Use>>,
}

impl Things {
    pub fn new(keep: Keep) -> Things {
        Things {
            keep,
            kinds: Vec::new(),
            same: Vec::new(),
            occurrences: Vec::new(),
            uses: FxHashMap::default(),
        }
    }

    /// Whether the names of things of a kind are kept.
    pub fn keeps(&self, kind: NameKind) -> bool {
        self.keep == Keep::All
            || !matches!(kind, NameKind::Block | NameKind::Instance | NameKind::Phase)
    }

    pub fn new_thing(&mut self, kind: NameKind, word: Symbol) -> Thing {
        let thing = Thing(self.kinds.len() as u32);
        self.kinds.push((kind, word));
        self.same.push(thing.0);
        thing
    }

    pub fn kind(&self, thing: Thing) -> NameKind {
        self.kinds[thing.0 as usize].0
    }

    /// Notes what a parameter is used as; other things may be used as they like.
    pub fn used(&mut self, thing: Thing, used: Use) {
        if self.kind(thing) == NameKind::Parameter {
            self.uses.entry(thing).or_default().push(used);
        }
    }

    pub fn occur(&mut self, thing: Thing, site: Site, declares: bool) {
        if !self.keeps(self.kind(thing)) {
            return;
        }
        self.occurrences.push(Occurrence {
            site,
            thing,
            declares,
        });
    }

    /// Makes all of these one; `None` if there is none.
    pub fn unite(&mut self, things: impl IntoIterator<Item = Thing>) -> Option<Thing> {
        let mut things = things.into_iter();
        let first = self.root(things.next()?);
        for other in things {
            let root = self.root(other);
            // The first of them stays, so that the order of files decides.
            self.same[root.0.max(first.0) as usize] = root.0.min(first.0);
        }
        Some(self.root(first))
    }

    fn root(&mut self, thing: Thing) -> Thing {
        let mut at = thing.0;
        while self.same[at as usize] != at {
            let next = self.same[at as usize];
            self.same[at as usize] = self.same[next as usize];
            at = next;
        }
        Thing(at)
    }

    /// Every name, by file and place.
    pub fn finish(mut self) -> Names {
        let mut occurrences = std::mem::take(&mut self.occurrences);
        for occurrence in &mut occurrences {
            occurrence.thing = self.root(occurrence.thing);
        }
        occurrences.sort_by_key(|occurrence| (occurrence.site.file, occurrence.site.span.start));
        occurrences.dedup_by_key(|occurrence| (occurrence.site.file, occurrence.site.span.start));
        let have_values = (occurrences.iter()).filter(|it| self.kind(it.thing).has_value());
        let values = have_values.map(|it| ((it.site.file, it.site.span.start), it.thing));
        Names {
            values: values.collect(),
            occurrences,
            kinds: self.kinds,
            uses: self.uses,
        }
    }
}

/// Numbers, counters and parameters, by block.
#[derive(Default)]
pub struct Bindings {
    words: FxHashMap<Symbol, Vec<Thing>>,
    order: Vec<Symbol>,
}

impl Bindings {
    pub fn mark(&self) -> usize {
        self.order.len()
    }

    pub fn restore(&mut self, mark: usize) {
        for word in self.order.drain(mark..) {
            if let Some(things) = self.words.get_mut(&word) {
                things.pop();
            }
        }
    }

    pub fn define(&mut self, word: Symbol, thing: Thing) {
        self.words.entry(word).or_default().push(thing);
        self.order.push(word);
    }

    pub fn get(&self, word: Symbol) -> Option<Thing> {
        self.words.get(&word)?.last().copied()
    }
}
