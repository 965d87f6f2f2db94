//! Resolves names of blocks: paths with indices and ranges.
use stochc_grammar::tree::{Place, Segment, Subscript};
use stochc_ir::Face;
use stochc_text::suggest::{Suggestion, nearest};

use super::expander::{Expander, Pass};
use super::scope::BoundValue;
use crate::diagnostic::{self, Code, Diagnostic, Fix};
use crate::expand::members::members;
use crate::expanded::NameKey;
use crate::names::ValueKind;

/// The blocks and the face that a text names.
pub struct ResolvedPlace {
    pub keys: Keys,
    /// Whether one of the indices is a range.
    pub ranged: bool,
    pub face: Option<Face>,
}

/// Names that differ in their indices. They are computed one by one, because their number can be
/// millions.
#[derive(Clone, Copy)]
pub struct Keys {
    key: NameKey,
    /// First and last value of each index, both included.
    bounds: [(i32, i32); NameKey::MAX_INDICES],
    count: usize,
}

impl Keys {
    fn one(key: NameKey) -> Keys {
        Keys {
            key,
            bounds: key.index.map(|index| (index, index)),
            count: 1,
        }
    }

    /// Returns the names. The last index changes fastest.
    pub fn iter(self) -> impl Iterator<Item = NameKey> {
        let Keys {
            mut key,
            bounds,
            count,
        } = self;
        (0..count as u64).map(move |mut rest| {
            let indices = key.index.iter_mut().zip(bounds);
            for (index, (first, last)) in indices.take(key.arity.into()).rev() {
                let span = (i64::from(last) - i64::from(first) + 1) as u64;
                *index = first + (rest % span) as i32;
                rest /= span;
            }
            key
        })
    }

    fn first(self) -> Option<NameKey> {
        self.iter().next()
    }
}

impl Expander<'_, '_> {
    /// Resolves a written name to blocks. Returns `None` and reports errors if there are any.
    pub fn place(&mut self, place: &Place) -> Option<ResolvedPlace> {
        let mut path = &place.path[..];
        let mut face = place.face.map(|(face, _)| face);
        // A parameter may stand for the face: `base.side -> T`.
        if let (None, [_, .., last]) = (face, path) {
            match self.value(last.name) {
                Some(BoundValue::Face(value)) => {
                    face = Some(value);
                    path = &path[..path.len() - 1];
                }
                Some(BoundValue::Unknown) => return None,
                _ => {}
            }
        }
        let (last, outer) = path.split_last()?;
        let mut scope = self.scope.instance;
        for (i, segment) in outer.iter().enumerate() {
            scope = self.instance_scope(scope, segment, &path[i + 1])?;
        }
        if outer.is_empty()
            && let Some(value) = self.value(last.name)
        {
            let keys = match value {
                BoundValue::Block(key) if last.index.is_none() => Keys::one(key),
                BoundValue::Unknown => return None,
                value => {
                    self.wrong_kind(last.name, value, ValueKind::Block);
                    return None;
                }
            };
            self.probe.note(self.file, path, keys.iter());
            return Some(ResolvedPlace {
                keys,
                ranged: false,
                face,
            });
        }
        let (keys, ranged) = self.keys(scope, last)?;
        self.probe.note(self.file, path, keys.iter());
        Some(ResolvedPlace { keys, ranged, face })
    }

    /// Resolves a name to one block, with its face if one is written.
    ///
    /// A range is an error, which is reported with this help and fix.
    pub fn single(
        &mut self,
        place: &Place,
        help: &str,
        fix: Option<Fix>,
    ) -> Option<(NameKey, Option<Face>)> {
        let blocks = self.place(place)?;
        if blocks.ranged {
            let location = self.location(place.span);
            let written = self.sources.text(location);
            let title = format!("one block is needed, but `{written}` is a range");
            let mut diagnostic = Diagnostic::new(Code::RangeMisused, title)
                .label(location, "only one block can stand here")
                .help(help);
            diagnostic.fix = fix;
            self.diagnostics.push(diagnostic);
            return None;
        }
        Some((blocks.keys.first()?, blocks.face))
    }

    /// Returns the new name that a text declares in the current scope. Returns `None` and reports
    /// an error if the text is not a new name.
    pub fn single_key(&mut self, place: &Place) -> Option<NameKey> {
        let segment = match &place.path[..] {
            [only] => only,
            _ => {
                self.diagnostics.push(
                    Diagnostic::new(Code::WrongKind, "a new name cannot have dots")
                        .label(
                            self.location(place.span),
                            "the name of a new block or instance",
                        )
                        .help("write a name without dots"),
                );
                return None;
            }
        };
        let (keys, ranged) = self.keys(self.scope.instance, segment)?;
        if ranged {
            self.diagnostics.push(
                Diagnostic::new(Code::RangeMisused, "one name is needed, not a range")
                    .label(self.location(place.span), "only one name can stand here")
                    .help("write the names one by one, or use a loop"),
            );
            return None;
        }
        keys.first()
    }

    /// Returns the scope of a named instance. `next` is the name inside the instance. Returns
    /// `None` and reports an error if the instance is unknown.
    fn instance_scope(&mut self, scope: u32, segment: &Segment, next: &Segment) -> Option<u32> {
        let (keys, ranged) = self.keys(scope, segment)?;
        if ranged {
            let diagnostic =
                Diagnostic::new(Code::RangeMisused, "one instance is needed, not a range")
                    .label(
                        self.location(segment.name.span),
                        "only one instance can stand here",
                    )
                    .help("use a loop: `for i in 1..3 { ... }`");
            self.diagnostics.push(self.in_instance(diagnostic));
            return None;
        }
        let key = keys.first()?;
        // While events are only counted, instances are unknown.
        let found = match self.pass {
            Pass::Writing => self.plan.roles.scope(&key),
            Pass::Counting => Some(scope),
        };
        if found.is_some() {
            return found;
        }
        let word = self.symbols.word(segment.name.symbol);
        let faces = Face::ALL.map(Face::word);
        let requested = self.symbols.word(next.name.symbol);
        let suggestion = suggested_face(requested).or_else(|| nearest(requested, faces));
        let is_block = self.plan.roles.get(&key).is_some()
            || matches!(self.value(segment.name), Some(BoundValue::Block(_)));
        let is_face = next.index.is_none() && (is_block || suggestion.is_some());
        if let (true, Some(value)) = (is_face, self.value(next.name)) {
            self.wrong_kind(next.name, value, ValueKind::Face);
            return None;
        }
        let diagnostic = if is_face {
            Diagnostic::about(Code::UnknownName, "`{}` is not a face", &[requested])
                .label(
                    self.location(next.name.span),
                    format!("unknown face of `{word}`"),
                )
                .suggest(self.location(next.name.span), suggestion, || {
                    "write up, down, north, south, east or west".to_owned()
                })
        } else if self.plan.uncertain.contains(&key.word) {
            return None;
        } else if let Some(diagnostic) = self.instance_around(key, segment) {
            diagnostic
        } else {
            // In a pattern, names belong to its own instance.
            let written = if key.scope == self.scope.instance {
                key.within(0)
            } else {
                key
            };
            let name = self.plan.roles.name_of(written, self.symbols);
            let format = "cannot find pattern instance `{}`";
            let diagnostic = Diagnostic::about(Code::UnknownName, format, &[&name]).label(
                self.location(segment.name.span),
                "no instance above has this name",
            );
            let roles = &self.plan.roles;
            match members(key, roles.instances(scope), roles, self.symbols) {
                Some(members) => diagnostic.help(members.describe("instance")),
                None => {
                    let known = roles.instances(scope);
                    let known = known.map(|known| self.symbols.word(known.word));
                    let known = diagnostic::suggestion(self.diagnostics, word, known);
                    diagnostic.suggest(self.location(segment.name.span), known, || {
                        format!("name the instance above this statement: `tower(A, 2) as {word}`")
                    })
                }
            }
        };
        self.diagnostics.push(self.in_instance(diagnostic));
        None
    }

    /// Returns an error if a pattern uses an instance from outside of the pattern.
    fn instance_around(&self, key: NameKey, segment: &Segment) -> Option<Diagnostic> {
        let grown = self.grown().filter(|_| key.scope == self.scope.instance)?;
        let roles = &self.plan.roles;
        let mut outer = std::iter::successors(roles.outer(key.scope), |&scope| roles.outer(scope));
        outer.find(|&scope| roles.scope(&key.within(scope)).is_some())?;
        let (word, pattern) = (key.word, grown.pattern);
        let (word, pattern) = (self.symbols.word(word), self.symbols.word(pattern));
        let format = "pattern `{}` cannot use the instance `{}`";
        let diagnostic = Diagnostic::about(Code::UnknownName, format, &[pattern, word]).label(
            self.location(segment.name.span),
            "unknown inside the pattern",
        );
        let help = "pass the block of the instance to the pattern, as an argument";
        Some(diagnostic.help(help))
    }

    /// Returns the names that a segment of a path stands for, and whether an index is a range.
    /// Returns `None` and reports an error if an index is wrong.
    fn keys(&mut self, scope: u32, segment: &Segment) -> Option<(Keys, bool)> {
        let mut key = NameKey {
            scope,
            word: segment.name.symbol,
            arity: 0,
            index: [0; NameKey::MAX_INDICES],
        };
        let Some(entries) = segment.index.as_deref() else {
            return Some((Keys::one(key), false));
        };
        if entries.len() > NameKey::MAX_INDICES {
            self.diagnostics.push(
                Diagnostic::new(
                    Code::WrongArguments,
                    format!("a name has more than {} indices", NameKey::MAX_INDICES),
                )
                .label(
                    self.location(segment.name.span),
                    format!("{} indices", entries.len()),
                )
                .help("combine some of them: `T[3 * i + j]`"),
            );
            return None;
        }
        key.arity = entries.len() as u8;
        let mut ranged = false;
        let mut bounds = [(0, 0); NameKey::MAX_INDICES];
        for (i, entry) in entries.iter().enumerate() {
            bounds[i] = match entry {
                Subscript::One(expr) => {
                    let value = self.index(expr)?;
                    (value, value)
                }
                Subscript::Range(first, last) => {
                    ranged = true;
                    (self.index(first)?, self.index(last)?)
                }
            };
        }
        let count = bounds[..entries.len()]
            .iter()
            .try_fold(1usize, |product, &(first, last)| {
                let span = usize::try_from(i64::from(last) - i64::from(first) + 1).unwrap_or(0);
                product.checked_mul(span)
            });
        let room = self.limits.events;
        let Some(count) = count.filter(|&count| count <= room) else {
            self.exhausted = true;
            self.outgrown = true;
            self.diagnostics.push(
                Diagnostic::new(
                    Code::ExpansionLimit,
                    format!("the program has more than {room} captures and releases"),
                )
                .label(
                    self.location(segment.name.span),
                    "this range alone has more",
                )
                .help(
                    self.limits
                        .help("check the ends of the range: both are included"),
                ),
            );
            return None;
        };
        if ranged {
            self.steps = self.steps.saturating_add(count);
        }
        let keys = Keys { key, bounds, count };
        Some((keys, ranged))
    }

    fn index(&mut self, expr: &stochc_grammar::tree::Expr) -> Option<i32> {
        let value = self.evaluate(expr)?;
        let index = i32::try_from(value).ok();
        if index.is_none() {
            self.diagnostics.push(
                Diagnostic::about(
                    Code::Arithmetic,
                    "index {} does not fit in 32 bits",
                    &[&value.to_string()],
                )
                .label(
                    self.location(expr.span),
                    "too large or too small for an index",
                )
                .help("use smaller numbers"),
            );
        }
        index
    }
}

/// Returns the face that another word for a direction probably means. Returns `None` if it means no
/// face.
pub(super) fn suggested_face(word: &str) -> Option<Suggestion> {
    let (face, clear) = match word {
        "top" | "above" | "upper" => (Face::Up, true),
        "bottom" | "below" | "lower" => (Face::Down, true),
        // East is on the right only for a reader of a map, so this fix is unsafe.
        "right" => (Face::East, false),
        "left" => (Face::West, false),
        "back" | "behind" => (Face::North, false),
        "front" => (Face::South, false),
        _ => return None,
    };
    Some(Suggestion {
        word: face.word().to_owned(),
        clear,
    })
}
