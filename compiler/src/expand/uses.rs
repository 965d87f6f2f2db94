//! Infers the kinds of pattern parameters from their uses.
use std::rc::Rc;

use rustc_hash::FxHashMap;
use stochc_grammar::tree::Pattern;

use super::{MAX_NESTING, Patterns};
use crate::names::{Names, Use, ValueKind};
use crate::{FileId, SourceLocation};

/// First location of each kind of use of a parameter. `None` for kinds without a use.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uses([Option<SourceLocation>; ValueKind::ALL.len()]);

impl Uses {
    /// Returns the kind of a parameter and the location of its use. Returns `None` if there are no
    /// uses or several kinds.
    pub fn only(&self) -> Option<(ValueKind, SourceLocation)> {
        let mut used = ValueKind::ALL
            .into_iter()
            .filter_map(|kind| Some((kind, self.0[kind as usize]?)));
        let first = used.next()?;
        used.next().is_none().then_some(first)
    }

    /// Returns whether the parameter is used.
    pub fn any(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    fn note(&mut self, kind: ValueKind, location: SourceLocation) {
        self.0[kind as usize].get_or_insert(location);
    }
}

#[derive(Debug, Default)]
pub struct KnownUses(FxHashMap<(FileId, u32), Rc<[Uses]>>);

impl KnownUses {
    /// Returns the uses of each parameter of a pattern. Includes its uses inside other patterns
    /// that get it as an argument.
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
        // A pattern that contains itself is reported when it is used.
        self.0.insert(key, uses.clone().into());
        if depth >= MAX_NESTING {
            return uses.into();
        }
        for (own, parameter) in uses.iter_mut().zip(&pattern.parameters) {
            for used in names.uses(file, parameter.name.span) {
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
