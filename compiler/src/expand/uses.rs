//! What the parameters of a pattern are used as.
use std::rc::Rc;

use rustc_hash::FxHashMap;
use stochc_grammar::tree::{
    Argument, Entry, Expr, ExprKind, Instance, Item, ItemKind, Pattern, Place, Segment,
};
use stochc_grammar::{Span, Symbol};

use super::MAX_NESTING;
use super::scope::Value;
use crate::{FileId, Site};

/// What an argument may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A block.
    Block,
    /// A whole number.
    Number,
    /// A face.
    Face,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 3] = [Kind::Block, Kind::Number, Kind::Face];

    /// What messages call one.
    pub const fn noun(self) -> &'static str {
        match self {
            Kind::Block => "a block",
            Kind::Number => "a number",
            Kind::Face => "a face",
        }
    }

    /// The kind of a value, if it could be worked out.
    pub fn of(value: Value) -> Option<Kind> {
        match value {
            Value::Block(_) => Some(Kind::Block),
            Value::Number(_) => Some(Kind::Number),
            Value::Face(_) => Some(Kind::Face),
            Value::Unknown => None,
        }
    }
}

/// The first place where a parameter is used as each kind of thing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uses([Option<Site>; Kind::ALL.len()]);

impl Uses {
    /// The kind it has to be, and where it is used so; `None` if it is not used, or in several ways.
    pub fn only(&self) -> Option<(Kind, Site)> {
        let mut used = Kind::ALL
            .into_iter()
            .filter_map(|kind| Some((kind, self.0[kind as usize]?)));
        let first = used.next()?;
        used.next().is_none().then_some(first)
    }

    /// Whether it is used at all.
    pub fn any(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    fn note(&mut self, kind: Kind, site: Site) {
        self.0[kind as usize].get_or_insert(site);
    }
}

/// Patterns by name, with their files.
type Patterns<'a> = FxHashMap<Symbol, (FileId, &'a Pattern)>;

/// What is known of the parameters of patterns, by the file and the first byte of their names.
#[derive(Debug, Default)]
pub struct Known(FxHashMap<(FileId, u32), Rc<[Uses]>>);

impl Known {
    /// The uses of each parameter of a pattern, also as an argument of the patterns that it grows.
    pub fn uses(&mut self, file: FileId, pattern: &Pattern, patterns: &Patterns<'_>) -> Rc<[Uses]> {
        self.uses_at(file, pattern, patterns, 0)
    }

    fn uses_at(
        &mut self,
        file: FileId,
        pattern: &Pattern,
        patterns: &Patterns<'_>,
        depth: usize,
    ) -> Rc<[Uses]> {
        let key = (file, pattern.name.span.start);
        if let Some(known) = self.0.get(&key) {
            return known.clone();
        }
        let nothing = vec![Uses::default(); pattern.parameters.len()];
        // A pattern that grows itself is told of when it does.
        self.0.insert(key, nothing.clone().into());
        if depth >= MAX_NESTING {
            return nothing.into();
        }
        let mut walk = Walk {
            known: self,
            patterns,
            file,
            depth,
            parameters: pattern.parameters.iter().map(|name| name.symbol).collect(),
            uses: nothing,
            hidden: Vec::new(),
            instances: Vec::new(),
        };
        walk.items(&pattern.body);
        let uses: Rc<[Uses]> = walk.uses.into();
        self.0.insert(key, uses.clone());
        uses
    }
}

/// A walk through the body of a pattern.
struct Walk<'w, 'a> {
    known: &'w mut Known,
    patterns: &'w Patterns<'a>,
    file: FileId,
    depth: usize,
    parameters: Vec<Symbol>,
    uses: Vec<Uses>,
    /// Counters and numbers that may hide parameters.
    hidden: Vec<Symbol>,
    /// The names of the instances so far.
    instances: Vec<Symbol>,
}

impl Walk<'_, '_> {
    /// The parameter that a word stands for.
    fn parameter(&self, word: Symbol) -> Option<usize> {
        let number = self.parameters.iter().position(|&name| name == word)?;
        (!self.hidden.contains(&word)).then_some(number)
    }

    fn note(&mut self, word: Symbol, kind: Kind, span: Span) {
        let site = Site {
            file: self.file,
            span,
        };
        if let Some(number) = self.parameter(word) {
            self.uses[number].note(kind, site);
        }
    }

    fn items(&mut self, items: &[Item]) {
        let mark = self.hidden.len();
        for item in items {
            self.item(item);
        }
        self.hidden.truncate(mark);
    }

    fn item(&mut self, item: &Item) {
        match &item.kind {
            ItemKind::Chain(chain) => {
                let links = chain.links.iter().map(|link| &link.place);
                let after = chain.after.iter().map(|subject| &subject.place);
                for place in std::iter::once(&chain.head).chain(links).chain(after) {
                    self.place(place);
                }
            }
            ItemKind::Release(release) => {
                let after = release.after.iter().map(|subject| &subject.place);
                for place in release.places.iter().chain(after) {
                    self.place(place);
                }
            }
            ItemKind::Instance(instance) => self.instance(instance),
            ItemKind::For(block) => {
                self.expr(&block.range.0);
                self.expr(&block.range.1);
                self.hidden.push(block.counter.symbol);
                self.items(&block.body);
                self.hidden.pop();
            }
            ItemKind::Let(let_) => {
                self.expr(&let_.value);
                self.hidden.push(let_.name.symbol);
            }
            // No part of a pattern, or nothing that a parameter is used in.
            _ => {}
        }
    }

    fn instance(&mut self, instance: &Instance) {
        let inner = (self.patterns.get(&instance.pattern.symbol)).map(|&(file, pattern)| {
            (self.known).uses_at(file, pattern, self.patterns, self.depth + 1)
        });
        for (i, argument) in instance.arguments.iter().enumerate() {
            match argument {
                Argument::Place(place) => self.place(place),
                Argument::Expr(Expr {
                    kind: ExprKind::Name(word),
                    ..
                }) => {
                    let inner = inner.as_ref().and_then(|uses| uses.get(i));
                    let own = self.parameter(*word);
                    if let (Some(own), Some(inner)) = (own, inner) {
                        for kind in Kind::ALL {
                            if let Some(site) = inner.0[kind as usize] {
                                self.uses[own].note(kind, site);
                            }
                        }
                    }
                }
                Argument::Expr(expr) => self.expr(expr),
            }
        }
        if let Some([only]) = instance.alias.as_ref().map(|alias| &alias.path[..]) {
            self.indices(only);
            self.instances.push(only.name.symbol);
        }
    }

    fn place(&mut self, place: &Place) {
        place.path.iter().for_each(|segment| self.indices(segment));
        let mut path = &place.path[..];
        // A parameter may stand for the face: `base.side -> T`.
        if let (None, [outer @ .., before, last]) = (place.face, path)
            && last.index.is_none()
            && !self.instances.contains(&before.name.symbol)
        {
            self.note(last.name.symbol, Kind::Face, last.name.span);
            path = &path[..outer.len() + 1];
        }
        if let [only] = path
            && only.index.is_none()
        {
            self.note(only.name.symbol, Kind::Block, only.name.span);
        }
    }

    fn indices(&mut self, segment: &Segment) {
        for entry in segment.index.iter().flat_map(|entries| entries.iter()) {
            match entry {
                Entry::One(expr) => self.expr(expr),
                Entry::Range(first, last) => {
                    self.expr(first);
                    self.expr(last);
                }
            }
        }
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Int(_) => {}
            ExprKind::Name(word) => self.note(*word, Kind::Number, expr.span),
            ExprKind::Negate(inner) => self.expr(inner),
            ExprKind::Binary(_, sides) => {
                self.expr(&sides.0);
                self.expr(&sides.1);
            }
        }
    }
}
