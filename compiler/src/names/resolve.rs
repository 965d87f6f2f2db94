//! Goes through the trees by the rules of scope.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::{
    Argument, Expr, ExprKind, Instance, Item, ItemKind, Name, Pattern, Place, Segment, Subscript,
    Tree,
};
use stochc_grammar::{Cancellation, Cancelled, Span, Symbol};

use super::things::{Bindings, Things};
use super::{Keep, NameKind, Names, Thing, Use, ValueKind};
use crate::{FileId, Site};

/// Resolves every name of a program's files.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
pub fn resolve<'a>(
    trees: impl Iterator<Item = (FileId, &'a Tree)>,
    keep: Keep,
    cancellation: Cancellation<'_>,
) -> Result<Names, Cancelled> {
    let mut resolver = Resolver {
        things: Things::new(keep),
        file: FileId(0),
        bindings: Bindings::default(),
        file_numbers: FxHashMap::default(),
        shared: FxHashMap::default(),
        realms: FxHashMap::default(),
        realm_count: 0,
        captured: FxHashSet::default(),
        blocks: FxHashMap::default(),
        grown: FxHashMap::default(),
        assemblies: Vec::new(),
        within: Within::File,
        realm: Realm(0),
        cancellation,
    };
    let trees: Vec<_> = trees.collect();
    for (file, tree) in &trees {
        resolver.file = *file;
        resolver.declare_file(&tree.items);
    }
    let mut number = 0;
    for (file, tree) in &trees {
        resolver.file = *file;
        for item in &tree.items {
            resolver.top(item, &mut number);
        }
    }
    // It may have been given up before its end.
    cancellation.check()?;
    Ok(resolver.things.finish())
}

/// Whose blocks and instances are spoken of: those of an assembly, or of a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Realm(u32);

/// What is gone through.
#[derive(Clone, Copy, PartialEq)]
enum Within {
    /// The file itself.
    File,
    /// An assembly, by number.
    Assembly(usize),
    /// A pattern of an assembly.
    OwnPattern(usize),
    /// A pattern of the file, which sees what the assemblies that grow it see.
    Pattern,
}

/// What an assembly declares for itself.
#[derive(Default)]
struct Own {
    numbers: FxHashMap<Symbol, Vec<Thing>>,
    /// The same, by the place of their names.
    lets: FxHashMap<u32, Thing>,
    named: FxHashMap<(NameKind, Symbol), Thing>,
}

struct Resolver<'c> {
    things: Things,
    file: FileId,
    bindings: Bindings,
    file_numbers: FxHashMap<Symbol, Thing>,
    /// Patterns, shapes and scenes of all files.
    shared: FxHashMap<(NameKind, Symbol), Thing>,
    /// For every pattern, whose names it has.
    realms: FxHashMap<Thing, Realm>,
    realm_count: u32,
    /// The words that are captured in each pattern.
    captured: FxHashSet<(Realm, Symbol)>,
    /// Blocks, instances and phases.
    blocks: FxHashMap<(Realm, NameKind, Symbol), Thing>,
    /// The patterns that the instances of a name have grown from.
    grown: FxHashMap<Thing, Vec<Realm>>,
    assemblies: Vec<Own>,
    within: Within,
    realm: Realm,
    cancellation: Cancellation<'c>,
}

impl Resolver<'_> {
    fn declare_file(&mut self, items: &[Item]) {
        let named = self.declare(items);
        self.shared.extend(named);
        for item in items {
            match &item.kind {
                ItemKind::Scene(scene) => {
                    let thing = self.scene(scene.name);
                    self.occur(thing, scene.name.span, true);
                }
                ItemKind::Let(let_) => {
                    self.expr(&let_.value);
                    let thing = self.bind(NameKind::Number, let_.name);
                    self.file_numbers.insert(let_.name.symbol, thing);
                }
                ItemKind::Assembly(assembly) => {
                    let mut own = Own {
                        named: self.declare(&assembly.body),
                        ..Own::default()
                    };
                    for item in &assembly.body {
                        if let ItemKind::Let(let_) = &item.kind {
                            let word = let_.name.symbol;
                            let thing = self.things.new_thing(NameKind::Number, word);
                            own.numbers.entry(word).or_default().push(thing);
                            own.lets.insert(let_.name.span.start, thing);
                        }
                    }
                    self.assemblies.push(own);
                }
                _ => {}
            }
        }
    }

    /// Patterns and shapes, which may stand behind their use.
    fn declare(&mut self, items: &[Item]) -> FxHashMap<(NameKind, Symbol), Thing> {
        let mut named = FxHashMap::default();
        for item in items {
            let (kind, name) = match &item.kind {
                ItemKind::Pattern(pattern) => (NameKind::Pattern, pattern.name),
                ItemKind::Shape(shape) => (NameKind::Shape, shape.name),
                _ => continue,
            };
            let thing = self.things.new_thing(kind, name.symbol);
            self.occur(thing, name.span, true);
            named.insert((kind, name.symbol), thing);
            if let ItemKind::Pattern(pattern) = &item.kind {
                let realm = self.new_realm();
                self.realms.insert(thing, realm);
                self.capture_words(&pattern.body, realm);
            }
        }
        named
    }

    fn capture_words(&mut self, items: &[Item], realm: Realm) {
        for item in items {
            match &item.kind {
                ItemKind::Chain(chain) => {
                    for link in &chain.links {
                        if let [only] = &link.place.path[..] {
                            self.captured.insert((realm, only.name.symbol));
                        }
                    }
                }
                ItemKind::For(block) => self.capture_words(&block.body, realm),
                _ => {}
            }
        }
    }

    fn new_realm(&mut self) -> Realm {
        self.realm_count += 1;
        Realm(self.realm_count)
    }

    fn top(&mut self, item: &Item, number: &mut usize) {
        self.within = Within::File;
        match &item.kind {
            ItemKind::Assembly(assembly) => {
                let thing = self
                    .things
                    .new_thing(NameKind::Assembly, assembly.name.symbol);
                self.occur(thing, assembly.name.span, true);
                if let Some(scene) = assembly.scene {
                    let thing = self.scene(scene);
                    self.occur(thing, scene.span, false);
                }
                self.within = Within::Assembly(*number);
                self.realm = self.new_realm();
                *number += 1;
                self.items(&assembly.body);
            }
            ItemKind::Aggregate(aggregate) => {
                let thing = (self.things).new_thing(NameKind::Aggregate, aggregate.name.symbol);
                self.occur(thing, aggregate.name.span, true);
                if let Some(scene) = aggregate.scene {
                    let thing = self.scene(scene);
                    self.occur(thing, scene.span, false);
                }
                self.expr(&aggregate.size);
            }
            ItemKind::Pattern(pattern) => self.pattern(pattern, Within::Pattern),
            ItemKind::Scene(scene) => {
                if let Some(base) = scene.base {
                    let thing = self.scene(base);
                    self.occur(thing, base.span, false);
                }
            }
            _ => {}
        }
    }

    /// A scene, declared or built in.
    fn scene(&mut self, name: Name) -> Thing {
        let key = (NameKind::Scene, name.symbol);
        if let Some(&thing) = self.shared.get(&key) {
            return thing;
        }
        let thing = self.things.new_thing(NameKind::Scene, name.symbol);
        self.shared.insert(key, thing);
        thing
    }

    fn pattern(&mut self, pattern: &Pattern, within: Within) {
        let Some(&realm) = (self.named(NameKind::Pattern, pattern.name.symbol))
            .and_then(|thing| self.realms.get(&thing))
        else {
            return;
        };
        let outer = (self.within, self.realm, std::mem::take(&mut self.bindings));
        (self.within, self.realm) = (within, realm);
        for &parameter in &pattern.parameters {
            self.bind(NameKind::Parameter, parameter);
        }
        self.items(&pattern.body);
        (self.within, self.realm, self.bindings) = outer;
    }

    fn items(&mut self, items: &[Item]) {
        let mark = self.bindings.mark();
        for item in items {
            if self.cancellation.is_cancelled() {
                break;
            }
            self.item(item);
        }
        self.bindings.restore(mark);
    }

    fn item(&mut self, item: &Item) {
        match &item.kind {
            ItemKind::Chain(chain) => {
                self.place(&chain.head, false);
                for link in &chain.links {
                    self.place(&link.place, true);
                }
                for subject in &chain.after {
                    self.place(&subject.place, false);
                }
            }
            ItemKind::Release(release) => {
                let subjects = release.after.iter().map(|subject| &subject.place);
                for place in release.places.iter().chain(subjects) {
                    self.place(place, false);
                }
            }
            ItemKind::Instance(instance) => self.instance(instance),
            ItemKind::Seat(seat) => {
                self.new_name(NameKind::Block, &seat.place);
                self.expr(&seat.at.0);
                self.expr(&seat.at.1);
            }
            ItemKind::For(block) => {
                self.expr(&block.range.0);
                self.expr(&block.range.1);
                let mark = self.bindings.mark();
                self.bind(NameKind::Counter, block.counter);
                self.items(&block.body);
                self.bindings.restore(mark);
            }
            ItemKind::Let(let_) => {
                self.expr(&let_.value);
                self.bind(NameKind::Number, let_.name);
            }
            ItemKind::Yields(name) => self.refer(NameKind::Shape, *name),
            ItemKind::Phase(phase) => {
                self.new_name(NameKind::Phase, &phase.name);
                self.items(&phase.body);
            }
            ItemKind::Seed(seed) => {
                self.expr(&seed.size.0);
                self.expr(&seed.size.1);
                self.items(&seed.body);
            }
            ItemKind::Pattern(pattern) => {
                if let Within::Assembly(number) = self.within {
                    self.pattern(pattern, Within::OwnPattern(number));
                }
            }
            // Codes of findings are no names of the program, and numbers in a shape have none; the others do not belong here.
            ItemKind::Level(_)
            | ItemKind::Shape(_)
            | ItemKind::Assembly(_)
            | ItemKind::Scene(_)
            | ItemKind::Aggregate(_)
            | ItemKind::Import(_) => {}
        }
    }

    fn instance(&mut self, instance: &Instance) {
        self.refer(NameKind::Pattern, instance.pattern);
        for (number, argument) in instance.arguments.iter().enumerate() {
            match argument {
                Argument::Expr(expr) => match expr.kind {
                    // A bare name is the number of that name, or else the block.
                    ExprKind::Name(word) => match self.number(word) {
                        Some(thing) => {
                            self.occur(thing, expr.span, false);
                            let used = Use::Argument(instance.pattern.symbol, number);
                            self.things.used(thing, used);
                        }
                        None => self.occur_block(self.realm, word, expr.span, false),
                    },
                    _ => self.expr(expr),
                },
                Argument::Place(place) => self.place(place, false),
            }
        }
        let Some(alias) = &instance.alias else { return };
        let realm = (self.named(NameKind::Pattern, instance.pattern.symbol))
            .and_then(|thing| self.realms.get(&thing).copied());
        if let (Some(thing), Some(realm)) = (self.new_name(NameKind::Instance, alias), realm) {
            let realms = self.grown.entry(thing).or_default();
            if !realms.contains(&realm) {
                realms.push(realm);
            }
        }
    }

    /// The name of something new in this realm.
    fn new_name(&mut self, kind: NameKind, place: &Place) -> Option<Thing> {
        let [segment] = &place.path[..] else {
            return None;
        };
        self.indices(segment);
        // What is inside of an instance is asked for whether its name is kept or not.
        if kind != NameKind::Instance && !self.things.keeps(kind) {
            return None;
        }
        let thing = self.block(self.realm, kind, segment.name.symbol);
        self.occur(thing, segment.name.span, true);
        Some(thing)
    }

    fn place(&mut self, place: &Place, captures: bool) {
        place.path.iter().for_each(|segment| self.indices(segment));
        let mut path = &place.path[..];
        // A parameter may stand for the face: `base.side -> T`.
        if let (None, [instances @ .., last]) = (place.face, path)
            && !instances.is_empty()
            && last.index.is_none()
            && let Some(thing) = self.parameter(last.name.symbol)
        {
            let inside = self.inside(instances);
            let is_block = (inside.iter().flatten())
                .any(|&realm| self.captured.contains(&(realm, last.name.symbol)));
            if !is_block {
                self.occur(thing, last.name.span, false);
                if inside.is_none() {
                    self.used_as(thing, ValueKind::Face, last.name.span);
                }
                path = instances;
            }
        }
        let Some((last, instances)) = path.split_last() else {
            return;
        };
        let word = last.name.symbol;
        if instances.is_empty() {
            match self.number(word) {
                Some(thing) => {
                    self.occur(thing, last.name.span, false);
                    if last.index.is_none() {
                        self.used_as(thing, ValueKind::Block, last.name.span);
                    }
                }
                None => self.occur_block(self.realm, word, last.name.span, captures),
            }
            return;
        }
        let Some(mut realms) = self.inside(instances) else {
            // A block and what may have been meant to be its face.
            if let [only] = instances
                && only.index.is_none()
                && let Some(thing) = self.parameter(only.name.symbol)
            {
                self.occur(thing, only.name.span, false);
                self.used_as(thing, ValueKind::Block, only.name.span);
            }
            return;
        };
        self.occur_instances(instances);
        if !self.things.keeps(NameKind::Block) {
            return;
        }
        if realms
            .iter()
            .any(|&realm| self.captured.contains(&(realm, word)))
        {
            realms.retain(|&realm| self.captured.contains(&(realm, word)));
        }
        let things: Vec<Thing> = (realms.into_iter())
            .map(|realm| self.block(realm, NameKind::Block, word))
            .collect();
        if let Some(thing) = self.things.unite(things) {
            self.occur(thing, last.name.span, captures);
        }
    }

    /// The parameter that a word stands for.
    fn parameter(&self, word: Symbol) -> Option<Thing> {
        let thing = self.bindings.get(word)?;
        (self.things.kind(thing) == NameKind::Parameter).then_some(thing)
    }

    fn used_as(&mut self, thing: Thing, kind: ValueKind, span: Span) {
        let site = self.site(span);
        self.things.used(thing, Use::As(kind, site));
    }

    /// The name of a block of a realm.
    fn occur_block(&mut self, realm: Realm, word: Symbol, span: Span, declares: bool) {
        if self.things.keeps(NameKind::Block) {
            let thing = self.block(realm, NameKind::Block, word);
            self.occur(thing, span, declares);
        }
    }

    /// The patterns inside of which a path of instances leads; `None` if one is unknown.
    fn inside(&self, instances: &[Segment]) -> Option<Vec<Realm>> {
        let mut realms = vec![self.realm];
        for segment in instances {
            let key = |realm| (realm, NameKind::Instance, segment.name.symbol);
            let things = realms
                .iter()
                .filter_map(|&realm| self.blocks.get(&key(realm)));
            let mut inside: Vec<Realm> = things
                .filter_map(|thing| self.grown.get(thing))
                .flatten()
                .copied()
                .collect();
            inside.sort_unstable_by_key(|realm| realm.0);
            inside.dedup();
            if inside.is_empty() {
                return None;
            }
            realms = inside;
        }
        Some(realms)
    }

    fn occur_instances(&mut self, instances: &[Segment]) {
        for (i, segment) in instances.iter().enumerate() {
            let realms = self.inside(&instances[..i]).unwrap_or_default();
            let key = |realm| (realm, NameKind::Instance, segment.name.symbol);
            let known = realms
                .into_iter()
                .filter_map(|realm| self.blocks.get(&key(realm)));
            let known: Vec<Thing> = known.copied().collect();
            if let Some(thing) = self.things.unite(known) {
                self.occur(thing, segment.name.span, false);
            }
        }
    }

    fn indices(&mut self, segment: &Segment) {
        for entry in segment.index.iter().flat_map(|entries| entries.iter()) {
            match entry {
                Subscript::One(expr) => self.expr(expr),
                Subscript::Range(first, last) => {
                    self.expr(first);
                    self.expr(last);
                }
            }
        }
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Int(_) => {}
            ExprKind::Name(word) => {
                if let Some(thing) = self.number(*word) {
                    self.occur(thing, expr.span, false);
                    self.used_as(thing, ValueKind::Number, expr.span);
                }
            }
            ExprKind::Negate(inner) => self.expr(inner),
            ExprKind::Binary(_, sides) => {
                self.expr(&sides.0);
                self.expr(&sides.1);
            }
        }
    }

    /// The number, counter or parameter of a word.
    fn number(&mut self, word: Symbol) -> Option<Thing> {
        if let Some(thing) = self.bindings.get(word) {
            return Some(thing);
        }
        let of = |own: &Own| own.numbers.get(&word).cloned().unwrap_or_default();
        let mut things: Vec<Thing> = match self.within {
            Within::File | Within::Assembly(_) => return None,
            Within::OwnPattern(number) => self.assemblies.get(number).map(of).unwrap_or_default(),
            Within::Pattern => self.assemblies.iter().flat_map(of).collect(),
        };
        things.extend(self.file_numbers.get(&word));
        self.things.unite(things)
    }

    /// The pattern or shape of a word.
    fn named(&mut self, kind: NameKind, word: Symbol) -> Option<Thing> {
        let own = |own: &Own| own.named.get(&(kind, word)).copied();
        let mut things: Vec<Thing> = match self.within {
            Within::Assembly(number) | Within::OwnPattern(number) => self
                .assemblies
                .get(number)
                .and_then(own)
                .into_iter()
                .collect(),
            Within::File | Within::Pattern => Vec::new(),
        };
        if things.is_empty() {
            things.extend(self.shared.get(&(kind, word)));
        }
        // A pattern of the file may be grown where only the assembly knows the word.
        if things.is_empty() && self.within == Within::Pattern {
            things.extend(self.assemblies.iter().filter_map(own));
            self.things.unite(things.iter().copied());
        }
        things.first().copied()
    }

    fn refer(&mut self, kind: NameKind, name: Name) {
        if let Some(thing) = self.named(kind, name.symbol) {
            self.occur(thing, name.span, false);
        }
    }

    fn bind(&mut self, kind: NameKind, name: Name) -> Thing {
        let own = match self.within {
            Within::Assembly(number) => self.assemblies.get(number),
            _ => None,
        };
        let own = own.and_then(|own| own.lets.get(&name.span.start).copied());
        let thing = own.unwrap_or_else(|| self.things.new_thing(kind, name.symbol));
        self.bindings.define(name.symbol, thing);
        self.occur(thing, name.span, true);
        thing
    }

    fn block(&mut self, realm: Realm, kind: NameKind, word: Symbol) -> Thing {
        let things = &mut self.things;
        *(self.blocks)
            .entry((realm, kind, word))
            .or_insert_with(|| things.new_thing(kind, word))
    }

    fn occur(&mut self, thing: Thing, span: Span, declares: bool) {
        let site = self.site(span);
        self.things.occur(thing, site, declares);
    }

    fn site(&self, span: Span) -> Site {
        Site {
            file: self.file,
            span,
        }
    }
}
