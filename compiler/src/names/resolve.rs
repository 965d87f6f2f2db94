//! Resolves names by the rules of scope.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::{
    ArgumentValue, Expectation, ExpectedEvent, Expr, ExprKind, Instance, Item, ItemKind, Name,
    Parameter, Pattern, Place, Segment, Subscript, Tree,
};
use stochc_grammar::{Cancellation, Cancelled, Span, Symbol};

use super::declared::{DeclaredName, DeclaredNames, DeclaredWords};
use super::definitions::{Bindings, Definitions};
use super::{Definition, Keep, NameKind, Names, Use, ValueKind};
use crate::{FileId, SourceLocation};

/// Resolves the names of all files of a program.
pub fn resolve<'a>(
    trees: impl Iterator<Item = (FileId, &'a Tree)>,
    keep: Keep,
    cancellation: Cancellation<'_>,
) -> Result<Names, Cancelled> {
    let mut resolver = Resolver {
        definitions: Definitions::new(keep),
        file: FileId(0),
        bindings: Bindings::default(),
        file_numbers: FxHashMap::default(),
        declared: DeclaredNames::default(),
        scopes: FxHashMap::default(),
        parameters: FxHashMap::default(),
        scope_count: 0,
        captured: FxHashSet::default(),
        blocks: FxHashMap::default(),
        grown: FxHashMap::default(),
        assemblies: Vec::new(),
        enclosing: EnclosingScope::File,
        scope: BlockScope(0),
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
    // A cancelled resolution is incomplete.
    cancellation.check()?;
    Ok(resolver.definitions.finish(resolver.declared))
}

/// Scope of the names of blocks and instances: an assembly or a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct BlockScope(u32);

/// Declaration around a statement.
#[derive(Clone, Copy, PartialEq)]
enum EnclosingScope {
    /// Top level of a file.
    File,
    /// An assembly, by number.
    Assembly(usize),
    /// A pattern of an assembly.
    OwnPattern(usize),
    /// A pattern at the top level of a file. It can use the numbers of every assembly that uses the
    /// pattern.
    Pattern,
}

#[derive(Default)]
struct OwnNumbers {
    numbers: FxHashMap<Symbol, Vec<Definition>>,
    /// Definitions of `let` declarations by the positions of their names.
    lets: FxHashMap<u32, Definition>,
}

struct Resolver<'c> {
    definitions: Definitions,
    file: FileId,
    bindings: Bindings,
    file_numbers: FxHashMap<Symbol, Definition>,
    /// Declared patterns, shapes and scenes.
    declared: DeclaredNames,
    /// Scope of the names in each pattern.
    scopes: FxHashMap<Definition, BlockScope>,
    /// Parameters of each pattern.
    parameters: FxHashMap<Definition, Vec<Definition>>,
    scope_count: u32,
    /// Captured words of each pattern.
    captured: FxHashSet<(BlockScope, Symbol)>,
    /// Definitions of blocks, instances and phases.
    blocks: FxHashMap<(BlockScope, NameKind, Symbol), Definition>,
    /// Patterns of each named instance.
    grown: FxHashMap<Definition, Vec<BlockScope>>,
    assemblies: Vec<OwnNumbers>,
    enclosing: EnclosingScope,
    scope: BlockScope,
    cancellation: Cancellation<'c>,
}

impl Resolver<'_> {
    fn declare_file(&mut self, items: &[Item]) {
        let named = self.declare(items);
        self.declared.shared.extend(named);
        for item in items {
            match &item.kind {
                ItemKind::Scene(scene) => {
                    let definition = self.scene(scene.name);
                    self.occur(definition, scene.name.span, true);
                }
                ItemKind::Let(let_) => {
                    self.expr(&let_.value);
                    let definition = self.bind(NameKind::Number, let_.name);
                    self.file_numbers.insert(let_.name.symbol, definition);
                }
                ItemKind::Assembly(assembly) => {
                    let place = (self.file, assembly.name.span.start);
                    let number = self.assemblies.len();
                    self.declared.assemblies.insert(place, number);
                    let named = self.declare(&assembly.body);
                    self.declared.own.push(named);
                    let mut own = OwnNumbers::default();
                    let declared = assembly.body.iter().filter_map(|item| match &item.kind {
                        ItemKind::Let(let_) => Some(&**let_),
                        _ => None,
                    });
                    for let_ in assembly.parameters.iter().chain(declared) {
                        let word = let_.name.symbol;
                        let definition = self.definitions.add(NameKind::Number, word);
                        own.numbers.entry(word).or_default().push(definition);
                        own.lets.insert(let_.name.span.start, definition);
                    }
                    self.assemblies.push(own);
                }
                _ => {}
            }
        }
    }

    /// Declares patterns and shapes before the resolution, because they may be used before their
    /// declaration.
    fn declare(&mut self, items: &[Item]) -> DeclaredWords {
        let mut named = DeclaredWords::default();
        for item in items {
            let (kind, name) = match &item.kind {
                ItemKind::Pattern(pattern) => (NameKind::Pattern, pattern.name),
                ItemKind::Shape(shape) => (NameKind::Shape, shape.name),
                _ => continue,
            };
            let definition = self.definitions.add(kind, name.symbol);
            self.occur(definition, name.span, true);
            let location = self.location(name.span);
            named.insert(
                (kind, name.symbol),
                DeclaredName {
                    definition,
                    location,
                },
            );
            if let ItemKind::Pattern(pattern) = &item.kind {
                let scope = self.new_scope();
                self.scopes.insert(definition, scope);
                let add = |parameter: &Parameter| {
                    (self.definitions).add(NameKind::Parameter, parameter.name.symbol)
                };
                let parameters = pattern.parameters.iter().map(add).collect();
                self.parameters.insert(definition, parameters);
                self.capture_words(&pattern.body, scope);
            }
        }
        named
    }

    fn capture_words(&mut self, items: &[Item], scope: BlockScope) {
        for item in items {
            match &item.kind {
                ItemKind::Chain(chain) => {
                    for link in &chain.links {
                        if let [only] = &link.place.path[..] {
                            self.captured.insert((scope, only.name.symbol));
                        }
                    }
                }
                ItemKind::Seat(seat) => {
                    if let [only] = &seat.place.path[..] {
                        self.captured.insert((scope, only.name.symbol));
                    }
                }
                ItemKind::For(_) | ItemKind::If(_) | ItemKind::Phase(_) => {
                    self.capture_words(item.body(), scope);
                }
                _ => {}
            }
        }
    }

    fn new_scope(&mut self) -> BlockScope {
        self.scope_count += 1;
        BlockScope(self.scope_count)
    }

    fn top(&mut self, item: &Item, number: &mut usize) {
        self.enclosing = EnclosingScope::File;
        match &item.kind {
            ItemKind::Assembly(assembly) => {
                let definition = self
                    .definitions
                    .add(NameKind::Assembly, assembly.name.symbol);
                self.occur(definition, assembly.name.span, true);
                if let Some(scene) = assembly.scene {
                    let definition = self.scene(scene);
                    self.occur(definition, scene.span, false);
                }
                self.enclosing = EnclosingScope::Assembly(*number);
                self.scope = self.new_scope();
                *number += 1;
                let mark = self.bindings.mark();
                for parameter in &assembly.parameters {
                    self.expr(&parameter.value);
                    self.bind(NameKind::Number, parameter.name);
                }
                self.items(&assembly.body);
                self.bindings.restore(mark);
            }
            ItemKind::Aggregate(aggregate) => {
                let definition = (self.definitions).add(NameKind::Aggregate, aggregate.name.symbol);
                self.occur(definition, aggregate.name.span, true);
                if let Some(scene) = aggregate.scene {
                    let definition = self.scene(scene);
                    self.occur(definition, scene.span, false);
                }
                self.expr(&aggregate.size);
            }
            ItemKind::Pattern(pattern) => self.pattern(pattern, EnclosingScope::Pattern),
            ItemKind::Scene(scene) => {
                if let Some(base) = scene.base {
                    let definition = self.scene(base);
                    self.occur(definition, base.span, false);
                }
            }
            _ => {}
        }
    }

    /// Resolves a scene, declared or built in.
    fn scene(&mut self, name: Name) -> Definition {
        let definitions = &mut self.definitions;
        let add = || definitions.add(NameKind::Scene, name.symbol);
        *self.declared.scenes.entry(name.symbol).or_insert_with(add)
    }

    fn pattern(&mut self, pattern: &Pattern, enclosing: EnclosingScope) {
        let definition = self.named(NameKind::Pattern, pattern.name.symbol);
        let Some((definition, &scope)) =
            definition.and_then(|it| Some((it, self.scopes.get(&it)?)))
        else {
            return;
        };
        let outer = (
            self.enclosing,
            self.scope,
            std::mem::take(&mut self.bindings),
        );
        (self.enclosing, self.scope) = (enclosing, scope);
        let declared = self
            .parameters
            .get(&definition)
            .cloned()
            .unwrap_or_default();
        for (parameter, definition) in pattern.parameters.iter().zip(declared) {
            parameter.default.iter().for_each(|it| self.value(it));
            self.bindings.define(parameter.name.symbol, definition);
            self.occur(definition, parameter.name.span, true);
        }
        self.items(&pattern.body);
        (self.enclosing, self.scope, self.bindings) = outer;
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
            ItemKind::If(block) => {
                block.condition.iter().for_each(|it| self.expr(it));
                self.items(&block.body);
            }
            ItemKind::Let(let_) => {
                self.value(&let_.value);
                self.bind(NameKind::Number, let_.name);
            }
            ItemKind::Yields(claim) => {
                self.refer(NameKind::Shape, claim.shape);
            }
            ItemKind::Expect(claim) => self.expectation(claim),
            ItemKind::Phase(phase) => {
                self.new_name(NameKind::Phase, &phase.name);
                self.items(&phase.body);
                phase.handler.iter().for_each(|it| self.handler(&it.body));
            }
            ItemKind::Seed(seed) => {
                self.expr(&seed.size.0);
                self.expr(&seed.size.1);
                self.items(&seed.body);
            }
            ItemKind::Pattern(pattern) => {
                if let EnclosingScope::Assembly(number) = self.enclosing {
                    self.pattern(pattern, EnclosingScope::OwnPattern(number));
                }
            }
            // Codes are not names, numbers of shapes contain none, and the others are misplaced
            // here.
            ItemKind::Level(_)
            | ItemKind::Shape(_)
            | ItemKind::Assembly(_)
            | ItemKind::Scene(_)
            | ItemKind::Aggregate(_)
            | ItemKind::Import(_)
            | ItemKind::Handler(_)
            | ItemKind::Wait(_)
            | ItemKind::Retry(_) => {}
        }
    }

    /// Resolves the names in a handler. Its `release` names the phase.
    fn handler(&mut self, items: &[Item]) {
        for item in items {
            match &item.kind {
                ItemKind::Release(release) => {
                    for place in &release.places {
                        self.name(NameKind::Phase, place, false);
                    }
                }
                ItemKind::Retry(count) => self.expr(count),
                _ => {}
            }
        }
    }

    fn expectation(&mut self, claim: &Expectation) {
        let Expectation::Probability { event, .. } = claim else {
            return;
        };
        match event {
            ExpectedEvent::Complete => {}
            ExpectedEvent::Phase(place) => self.phase(place),
            ExpectedEvent::Captured { block, by } => {
                self.place(block, false);
                self.place(by, false);
            }
        }
    }

    /// Resolves the name of a phase.
    fn phase(&mut self, place: &Place) {
        let [segment] = &place.path[..] else {
            return;
        };
        self.indices(segment);
        if self.definitions.stores(NameKind::Phase) {
            let definition = self.block(self.scope, NameKind::Phase, segment.name.symbol);
            self.occur(definition, segment.name.span, false);
        }
    }

    fn instance(&mut self, instance: &Instance) {
        let pattern = self.refer(NameKind::Pattern, instance.pattern);
        let parameters = pattern.and_then(|it| self.parameters.get(&it).cloned());
        let parameters = parameters.unwrap_or_default();
        for (position, argument) in instance.arguments.iter().enumerate() {
            let mut number = position;
            if let Some(name) = argument.name {
                let is_named = |it: &Definition| self.definitions.word(*it) == name.symbol;
                let Some(found) = parameters.iter().position(is_named) else {
                    continue;
                };
                self.occur(parameters[found], name.span, false);
                number = found;
            }
            match &argument.value {
                ArgumentValue::Expr(expr) => match expr.kind {
                    // A bare name is the number with this name, or else the block.
                    ExprKind::Name(word) => match self.number(word) {
                        Some(definition) => {
                            self.occur(definition, expr.span, false);
                            if let Some(pattern) = pattern {
                                self.definitions
                                    .used(definition, Use::Argument(pattern, number));
                            }
                        }
                        None => self.occur_block(self.scope, word, expr.span, false),
                    },
                    _ => self.expr(expr),
                },
                ArgumentValue::Place(place) => self.place(place, false),
            }
        }
        if let Some(placement) = &instance.placement {
            placement.turned.iter().for_each(|it| self.expr(it));
            for it in placement.at.iter().flat_map(|(x, y)| [x, y]) {
                self.expr(it);
            }
        }
        let Some(alias) = &instance.alias else { return };
        let scope = pattern.and_then(|definition| self.scopes.get(&definition).copied());
        if let (Some(definition), Some(scope)) = (self.new_name(NameKind::Instance, alias), scope) {
            let scopes = self.grown.entry(definition).or_default();
            if !scopes.contains(&scope) {
                scopes.push(scope);
            }
        }
    }

    /// Declares a new name in the current scope. Returns `None` if its kind is not recorded.
    fn new_name(&mut self, kind: NameKind, place: &Place) -> Option<Definition> {
        self.name(kind, place, true)
    }

    /// Resolves a name of one word in the current scope. Returns `None` if its kind is not
    /// recorded.
    fn name(&mut self, kind: NameKind, place: &Place, is_new: bool) -> Option<Definition> {
        let [segment] = &place.path[..] else {
            return None;
        };
        self.indices(segment);
        // Names inside an instance are resolved even if the instance's name is not recorded.
        if kind != NameKind::Instance && !self.definitions.stores(kind) {
            return None;
        }
        let definition = self.block(self.scope, kind, segment.name.symbol);
        self.occur(definition, segment.name.span, is_new);
        Some(definition)
    }

    fn place(&mut self, place: &Place, captures: bool) {
        place.path.iter().for_each(|segment| self.indices(segment));
        let mut path = &place.path[..];
        // A parameter may stand for the face: `base.side -> T`.
        if let (None, [instances @ .., last]) = (place.face, path)
            && !instances.is_empty()
            && last.index.is_none()
            && let inside = self.inside(instances)
            && let Some(definition) = self.face_name(last.name.symbol, inside.is_none())
        {
            let is_block = (inside.iter().flatten())
                .any(|&scope| self.captured.contains(&(scope, last.name.symbol)));
            if !is_block {
                self.occur(definition, last.name.span, false);
                if inside.is_none() {
                    self.used_as(definition, ValueKind::Face, last.name.span);
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
                Some(definition) => {
                    self.occur(definition, last.name.span, false);
                    if last.index.is_none() {
                        self.used_as(definition, ValueKind::Block, last.name.span);
                    }
                }
                None => self.occur_block(self.scope, word, last.name.span, captures),
            }
            return;
        }
        let Some(mut scopes) = self.inside(instances) else {
            // A block without a face: the last word is not a face.
            if let [only] = instances
                && only.index.is_none()
                && let Some(definition) = self.parameter(only.name.symbol)
            {
                self.occur(definition, only.name.span, false);
                self.used_as(definition, ValueKind::Block, only.name.span);
            }
            return;
        };
        self.occur_instances(instances);
        if !self.definitions.stores(NameKind::Block) {
            return;
        }
        if scopes
            .iter()
            .any(|&scope| self.captured.contains(&(scope, word)))
        {
            scopes.retain(|&scope| self.captured.contains(&(scope, word)));
        }
        let definitions: Vec<Definition> = (scopes.into_iter())
            .map(|scope| self.block(scope, NameKind::Block, word))
            .collect();
        if let Some(definition) = self.definitions.unite(definitions) {
            self.occur(definition, last.name.span, captures);
        }
    }

    /// Returns the parameter or the named value that can be the face of a block. In a path of
    /// instances, only parameters can be faces.
    fn face_name(&mut self, word: Symbol, is_after_block: bool) -> Option<Definition> {
        match self.parameter(word) {
            None if is_after_block => self.number(word),
            parameter => parameter,
        }
    }

    /// Resolves a number or a face. A bare name may be either, so it is no evidence of the kind.
    fn value(&mut self, expr: &Expr) {
        match expr.kind {
            ExprKind::Name(word) => {
                if let Some(definition) = self.number(word) {
                    self.occur(definition, expr.span, false);
                }
            }
            _ => self.expr(expr),
        }
    }

    /// Returns the parameter that a word names. Returns `None` for other words.
    fn parameter(&self, word: Symbol) -> Option<Definition> {
        let definition = self.bindings.get(word)?;
        (self.definitions.kind(definition) == NameKind::Parameter).then_some(definition)
    }

    fn used_as(&mut self, definition: Definition, kind: ValueKind, span: Span) {
        let location = self.location(span);
        self.definitions.used(definition, Use::As(kind, location));
    }

    /// Resolves the name of a block.
    fn occur_block(&mut self, scope: BlockScope, word: Symbol, span: Span, declares: bool) {
        if self.definitions.stores(NameKind::Block) {
            let definition = self.block(scope, NameKind::Block, word);
            self.occur(definition, span, declares);
        }
    }

    /// Returns the patterns of the last instance in a path of instances. Returns `None` if an
    /// instance is unknown.
    fn inside(&self, instances: &[Segment]) -> Option<Vec<BlockScope>> {
        let mut scopes = vec![self.scope];
        for segment in instances {
            let key = |scope| (scope, NameKind::Instance, segment.name.symbol);
            let definitions = scopes
                .iter()
                .filter_map(|&scope| self.blocks.get(&key(scope)));
            let mut inside: Vec<BlockScope> = definitions
                .filter_map(|definition| self.grown.get(definition))
                .flatten()
                .copied()
                .collect();
            inside.sort_unstable_by_key(|scope| scope.0);
            inside.dedup();
            if inside.is_empty() {
                return None;
            }
            scopes = inside;
        }
        Some(scopes)
    }

    fn occur_instances(&mut self, instances: &[Segment]) {
        for (i, segment) in instances.iter().enumerate() {
            let scopes = self.inside(&instances[..i]).unwrap_or_default();
            let key = |scope| (scope, NameKind::Instance, segment.name.symbol);
            let known = scopes
                .into_iter()
                .filter_map(|scope| self.blocks.get(&key(scope)));
            let known: Vec<Definition> = known.copied().collect();
            if let Some(definition) = self.definitions.unite(known) {
                self.occur(definition, segment.name.span, false);
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
            ExprKind::Int(_) | ExprKind::Face(_) => {}
            ExprKind::Name(word) => {
                if let Some(definition) = self.number(*word) {
                    self.occur(definition, expr.span, false);
                    self.used_as(definition, ValueKind::Number, expr.span);
                }
            }
            ExprKind::Negate(inner) | ExprKind::Not(inner) => self.expr(inner),
            ExprKind::Call(function, arguments) if function.takes_face() => {
                for argument in arguments {
                    self.value(argument);
                    if let ExprKind::Name(word) = argument.kind
                        && let Some(definition) = self.parameter(word)
                    {
                        self.used_as(definition, ValueKind::Face, argument.span);
                    }
                }
            }
            ExprKind::Call(_, arguments) => arguments.iter().for_each(|it| self.expr(it)),
            ExprKind::Binary(_, sides) => {
                self.expr(&sides.0);
                self.expr(&sides.1);
            }
        }
    }

    /// Returns the number, counter or parameter that a word names. Returns `None` for other words.
    fn number(&mut self, word: Symbol) -> Option<Definition> {
        if let Some(definition) = self.bindings.get(word) {
            return Some(definition);
        }
        let of = |own: &OwnNumbers| own.numbers.get(&word).cloned().unwrap_or_default();
        let mut definitions: Vec<Definition> = match self.enclosing {
            EnclosingScope::File | EnclosingScope::Assembly(_) => return None,
            EnclosingScope::OwnPattern(number) => {
                self.assemblies.get(number).map(of).unwrap_or_default()
            }
            EnclosingScope::Pattern => self.assemblies.iter().flat_map(of).collect(),
        };
        definitions.extend(self.file_numbers.get(&word));
        self.definitions.unite(definitions)
    }

    /// Returns the pattern or shape that a word names. Returns `None` if the word is not declared.
    fn named(&mut self, kind: NameKind, word: Symbol) -> Option<Definition> {
        let assembly = match self.enclosing {
            EnclosingScope::Assembly(number) | EnclosingScope::OwnPattern(number) => Some(number),
            EnclosingScope::File | EnclosingScope::Pattern => None,
        };
        let seen = self.declared.seen_from(assembly, kind, word);
        if seen.is_some() || self.enclosing != EnclosingScope::Pattern {
            return seen.map(|it| it.definition);
        }
        // A pattern of the file may be used in an assembly that declares the word.
        let own = self.declared.own.iter();
        let own: Vec<Definition> = own
            .filter_map(|own| own.get(&(kind, word)))
            .map(|it| it.definition)
            .collect();
        self.definitions.unite(own.iter().copied());
        own.first().copied()
    }

    fn refer(&mut self, kind: NameKind, name: Name) -> Option<Definition> {
        let definition = self.named(kind, name.symbol)?;
        self.occur(definition, name.span, false);
        Some(definition)
    }

    fn bind(&mut self, kind: NameKind, name: Name) -> Definition {
        let own = match self.enclosing {
            EnclosingScope::Assembly(number) => self.assemblies.get(number),
            _ => None,
        };
        let own = own.and_then(|own| own.lets.get(&name.span.start).copied());
        let definition = own.unwrap_or_else(|| self.definitions.add(kind, name.symbol));
        self.bindings.define(name.symbol, definition);
        self.occur(definition, name.span, true);
        definition
    }

    fn block(&mut self, scope: BlockScope, kind: NameKind, word: Symbol) -> Definition {
        let definitions = &mut self.definitions;
        *(self.blocks)
            .entry((scope, kind, word))
            .or_insert_with(|| definitions.add(kind, word))
    }

    fn occur(&mut self, definition: Definition, span: Span, declares: bool) {
        let location = self.location(span);
        self.definitions.occur(definition, location, declares);
    }

    fn location(&self, span: Span) -> SourceLocation {
        SourceLocation {
            file: self.file,
            span,
        }
    }
}
