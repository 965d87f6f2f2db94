//! The things that words stand for, and those that turn out to be one.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbol;

use super::{Kind, Names, Occurrence, Thing};
use crate::Site;

/// Things, found one after the other.
#[derive(Default)]
pub struct Things {
    kinds: Vec<(Kind, Symbol)>,
    /// For every thing, another one that it is the same as, or itself.
    same: Vec<u32>,
    occurrences: Vec<Occurrence>,
}

impl Things {
    pub fn new_thing(&mut self, kind: Kind, word: Symbol) -> Thing {
        let thing = Thing(self.kinds.len() as u32);
        self.kinds.push((kind, word));
        self.same.push(thing.0);
        thing
    }

    pub fn kind(&self, thing: Thing) -> Kind {
        self.kinds[thing.0 as usize].0
    }

    pub fn occur(&mut self, thing: Thing, site: Site, declares: bool) {
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
        Names {
            occurrences,
            kinds: self.kinds,
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
