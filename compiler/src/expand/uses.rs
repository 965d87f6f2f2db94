//! What the parameters of a pattern have to be, by what they are used as in it and in the patterns that it grows.
use std::rc::Rc;

use rustc_hash::FxHashMap;
use stochc_grammar::tree::Pattern;

use super::{MAX_NESTING, Patterns};
use crate::names::{Names, Use, ValueKind};
use crate::{FileId, SourceLocation};

/// The first place where a parameter is used as each kind of thing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uses([Option<SourceLocation>; ValueKind::ALL.len()]);

impl Uses {
    /// The kind it has to be, and where it is used so; `None` if it is not used, or in several ways.
    pub fn only(&self) -> Option<(ValueKind, SourceLocation)> {
        let mut used = ValueKind::ALL
            .into_iter()
            .filter_map(|kind| Some((kind, self.0[kind as usize]?)));
        let first = used.next()?;
        used.next().is_none().then_some(first)
    }

    /// Whether it is used at all.
    pub fn any(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    fn note(&mut self, kind: ValueKind, location: SourceLocation) {
        self.0[kind as usize].get_or_insert(location);
    }
}

/// What is known of the parameters of patterns, by the file and the first byte of their names.
#[derive(Debug, Default)]
pub struct KnownUses(FxHashMap<(FileId, u32), Rc<[Uses]>>);

impl KnownUses {
    /// The uses of each parameter of a pattern, also as an argument of the patterns that it grows.
    pub fn uses(
        &mut self,
        pattern: (FileId, &Pattern),
        patterns: &Patterns<'_>,
        names: &Names,
    ) -> Rc<[Uses]> {
        self.uses_at(pattern, patterns, names, 0)
    }

    fn uses_at(
        &mut self,
        (file, pattern): (FileId, &Pattern),
        patterns: &Patterns<'_>,
        names: &Names,
        depth: usize,
    ) -> Rc<[Uses]> {
        let key = (file, pattern.name.span.start);
        if let Some(known) = self.0.get(&key) {
            return known.clone();
        }
        let mut uses = vec![Uses::default(); pattern.parameters.len()];
        // A pattern that grows itself is told of when it does.
        self.0.insert(key, uses.clone().into());
        if depth >= MAX_NESTING {
            return uses.into();
        }
        for (own, parameter) in uses.iter_mut().zip(&pattern.parameters) {
            for used in names.uses(file, parameter.span) {
                match *used {
                    Use::As(kind, location) => own.note(kind, location),
                    Use::Argument(inner, number) => {
                        let Some(&inner) = patterns.get(&inner) else {
                            continue;
                        };
                        let inner = self.uses_at(inner, patterns, names, depth + 1);
                        for kind in ValueKind::ALL {
                            if let Some(location) =
                                inner.get(number).and_then(|it| it.0[kind as usize])
                            {
                                own.note(kind, location);
                            }
                        }
                    }
                }
            }
        }
        let uses: Rc<[Uses]> = uses.into();
        self.0.insert(key, uses.clone());
        uses
    }
}
