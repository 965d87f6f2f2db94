//! Writes an `after` as a change of the source.
use stochc_grammar::tree::{Chain, Expr, ExprKind, Item, ItemKind, Operator, Place, Subscript};
use stochc_grammar::{Span, Symbol};
use stochc_ir::table::RoleId;

use super::ValidProgram;
use crate::diagnostic::Edit;
use crate::expanded::EventId;
use crate::expanded::{EventKind, NameKey};
use crate::{FileId, SourceLocation};

/// An arrow of a chain. In a range, loop or pattern, one arrow makes many captures.
#[derive(Clone, Copy)]
pub struct CaptureStatement<'a> {
    chain: &'a Chain,
    link: usize,
}

impl<'a> CaptureStatement<'a> {
    /// Returns the statement of a capture in the program's own file. Returns `None` if the capture
    /// is in another file.
    pub fn new(subject: &ValidProgram<'a>, capture: EventId) -> Option<CaptureStatement<'a>> {
        let SourceLocation { file, span } = subject.plan.event(capture).location;
        if file != subject.file {
            return None;
        }
        let patterns = subject.patterns.values();
        let patterns = patterns.filter(|(of, _)| *of == file);
        find(&subject.assembly.body, span).or_else(|| {
            patterns
                .into_iter()
                .find_map(|(_, pattern)| find(&pattern.body, span))
        })
    }

    /// Returns the capturing block and the captured block of the arrow.
    fn places(&self) -> (&'a Place, &'a Place) {
        let CaptureStatement { chain, link } = *self;
        let parent = link
            .checked_sub(1)
            .map_or(&chain.head, |link| &chain.links[link].place);
        (parent, &chain.links[link].place)
    }

    /// Returns whether the arrow is the first of its chain. An `after` of the statement delays the
    /// first arrow.
    pub fn is_first(&self) -> bool {
        self.link == 0
    }

    /// Returns the source of the file.
    pub fn text(&self, subject: &ValidProgram<'a>) -> &'a str {
        let (parent, child) = self.places();
        let place = location(subject.file, parent.span.start, child.span.end);
        subject.sources.text(place)
    }

    /// Returns the possible spellings of a block's name at the statement of `capture`, the
    /// likeliest first.
    ///
    /// Spellings with loop counters come first, and the plain name last. Returns an empty list if
    /// the block has no name there.
    pub fn names(&self, subject: &ValidProgram, capture: EventId, role: RoleId) -> Vec<String> {
        let roles = &subject.plan.roles;
        let (parent, child) = self.places();
        let event = subject.plan.event(capture);
        let own = roles.path(event.role);
        let Some(inner) = ending(child, &own) else {
            return Vec::new();
        };
        let scope = inner[0].scope;
        let path = roles.path(role);
        let Some(from) = path.iter().position(|key| key.scope == scope) else {
            return Vec::new();
        };
        let mut counters: Vec<(Symbol, i64)> = Vec::new();
        solve(child, inner, &mut counters);
        if let EventKind::Capture { parent: by, .. } = event.kind {
            let by = roles.path(by);
            if let Some(keys) = ending(parent, &by) {
                solve(parent, keys, &mut counters);
            }
        }
        // Each spelling with its distance from the likeliest one.
        let mut names: Vec<(u64, String)> = vec![(0, String::new())];
        for (i, key) in path[from..].iter().enumerate() {
            let word = subject.symbols.word(key.word);
            if word.contains('#') {
                return Vec::new();
            }
            let dot = if i == 0 { "" } else { "." };
            names
                .iter_mut()
                .for_each(|(_, name)| *name += &format!("{dot}{word}"));
            for (k, &index) in key.index[..key.arity as usize].iter().enumerate() {
                let begin = if k == 0 { "[" } else { ", " };
                let end = if k + 1 == usize::from(key.arity) {
                    "]"
                } else {
                    ""
                };
                let written = indices(i64::from(index), &counters, subject);
                names = (names.iter())
                    .flat_map(|(cost, name)| {
                        (written.iter()).map(move |(extra, index)| {
                            // Usually, each counter is used in one index.
                            let again = u64::from(begin == ", " && stands_in(name, index));
                            (cost + extra + again, format!("{name}{begin}{index}{end}"))
                        })
                    })
                    .take(MAX_NAMES)
                    .collect();
            }
        }
        names.sort_by_key(|(cost, _)| *cost);
        names.into_iter().map(|(_, name)| name).collect()
    }

    /// Returns the edits that make the captures of the statement wait for a block.
    pub fn wait(&self, subject: &ValidProgram, name: &str) -> Vec<Edit> {
        let CaptureStatement { chain, link } = *self;
        let at = |start: u32, end: u32, text: String| Edit {
            location: location(subject.file, start, end),
            text,
        };
        let end = chain
            .links
            .last()
            .map_or(chain.head.span, |link| link.place.span)
            .end;
        let end_of_after = chain
            .after
            .last()
            .map_or(end, |subject| subject.place.span.end);
        if link == 0 {
            let text = if chain.after.is_empty() {
                " after "
            } else {
                ", "
            };
            return vec![at(end_of_after, end_of_after, format!("{text}{name}"))];
        }
        // Only the first capture of a chain can wait, so the chain continues on its own line.
        let (place, _) = self.places();
        let text_of = |start, end| subject.sources.text(location(subject.file, start, end));
        let block = match place.face {
            Some((_, face)) => text_of(place.span.start, face.start)
                .trim_end()
                .trim_end_matches('.'),
            None => text_of(place.span.start, place.span.end),
        };
        // The last block of a row continues the chain.
        let mut again = String::new();
        let mut from = place.span.start;
        let entries = place
            .path
            .iter()
            .filter_map(|segment| segment.index.as_deref());
        for entry in entries.flatten() {
            if let Subscript::Range(first, last) = entry {
                again.push_str(text_of(from, first.span.start));
                from = last.span.start;
            }
        }
        again.push_str(text_of(from, place.span.end));
        let waits = text_of(end, end_of_after);
        let indent = subject
            .sources
            .indent(location(subject.file, chain.head.span.start, end));
        vec![
            at(
                place.span.start,
                place.span.end,
                format!("{block}{waits}\n{indent}{again}"),
            ),
            at(end, end_of_after, format!(" after {name}")),
        ]
    }
}

/// Largest number of spellings of a block's name.
const MAX_NAMES: usize = 64;

/// Returns the arrow of a chain at this source range. Returns `None` if there is no arrow.
fn find(items: &[Item], span: Span) -> Option<CaptureStatement<'_>> {
    items.iter().find_map(|item| match &item.kind {
        ItemKind::Chain(chain) => (0..chain.links.len())
            .map(|link| CaptureStatement { chain, link })
            .find(|statement| {
                let (parent, child) = statement.places();
                (parent.span.start, child.span.end) == (span.start, span.end)
            }),
        ItemKind::Phase(phase) => find(&phase.body, span),
        ItemKind::For(_) | ItemKind::If(_) => find(item.body(), span),
        ItemKind::Pattern(pattern) => find(&pattern.body, span),
        _ => None,
    })
}

/// Returns the part of a role's path that the source spells out. Returns `None` if the source uses
/// a parameter.
fn ending<'k>(place: &Place, path: &'k [NameKey]) -> Option<&'k [NameKey]> {
    let from = path.len().checked_sub(place.path.len())?;
    let is_written = (place.path.iter().zip(&path[from..])).all(|(segment, key)| {
        segment.name.symbol == key.word
            && segment.index.as_deref().map_or(0, <[Subscript]>::len) == usize::from(key.arity)
    });
    (is_written && from < path.len()).then_some(&path[from..])
}

/// Returns whether `index` is one of the indices in the last brackets of a written name.
fn stands_in(name: &str, index: &str) -> bool {
    let indices = name.rsplit('[').next().unwrap_or_default();
    indices.split(", ").any(|other| other == index)
}

/// Records the values of loop counters. Uses only indices that consist of a counter, or of a
/// counter and a number.
fn solve(place: &Place, keys: &[NameKey], counters: &mut Vec<(Symbol, i64)>) {
    for (segment, key) in place.path.iter().zip(keys) {
        let entries = segment.index.as_deref().unwrap_or_default();
        for (entry, &index) in entries.iter().zip(&key.index) {
            let Subscript::One(expr) = entry else {
                continue;
            };
            let found = counter(expr, i64::from(index));
            if let Some((name, value)) = found
                && counters.iter().all(|&(known, _)| known != name)
            {
                counters.push((name, value));
            }
        }
    }
}

/// Returns the counter of an index, and its value if the index has the value `value`. Returns
/// `None` for any other form of index.
fn counter(expr: &Expr, value: i64) -> Option<(Symbol, i64)> {
    match &expr.kind {
        ExprKind::Name(name) => Some((*name, value)),
        ExprKind::Binary(operator, sides) => match (operator, &sides.0.kind, &sides.1.kind) {
            (Operator::Add, ExprKind::Name(name), ExprKind::Int(number))
            | (Operator::Add, ExprKind::Int(number), ExprKind::Name(name)) => {
                Some((*name, value.checked_sub(*number)?))
            }
            (Operator::Subtract, ExprKind::Name(name), ExprKind::Int(number)) => {
                Some((*name, value.checked_add(*number)?))
            }
            _ => None,
        },
        _ => None,
    }
}

/// Returns the possible spellings of an index. Each has a distance, which is small for likely
/// spellings.
fn indices(index: i64, counters: &[(Symbol, i64)], subject: &ValidProgram) -> Vec<(u64, String)> {
    let mut written: Vec<(u64, String)> = (counters.iter())
        .map(|&(name, value)| {
            let name = subject.symbols.word(name);
            let far = index - value;
            let text = match far {
                0 => name.to_owned(),
                1.. => format!("{name} + {far}"),
                _ => format!("{name} - {}", -far),
            };
            (far.unsigned_abs(), text)
        })
        .collect();
    written.push((2, index.to_string()));
    written
}

fn location(file: FileId, start: u32, end: u32) -> SourceLocation {
    SourceLocation {
        file,
        span: Span { start, end },
    }
}
