//! Tree to JSON.
use serde_json::{Map, Value, json};

use crate::Symbols;
use crate::tree::{
    Argument, Arrow, Entry, Expr, ExprKind, Item, ItemKind, Place, Quantity, Subject, Term, Tree,
};

/// The tree with every word written out: a list of items, each an object with its `kind`, its
/// `span` in bytes and what belongs to the kind.
pub fn to_json(tree: &Tree, symbols: &Symbols) -> Value {
    Writer { symbols }.items(&tree.items)
}

struct Writer<'a> {
    symbols: &'a Symbols,
}

impl Writer<'_> {
    fn items(&self, items: &[Item]) -> Value {
        items.iter().map(|item| self.item(item)).collect()
    }

    fn word(&self, symbol: crate::Symbol) -> Value {
        self.symbols.word(symbol).into()
    }

    fn item(&self, item: &Item) -> Value {
        let (kind, fields) = match &item.kind {
            ItemKind::Chain(chain) => {
                let links: Value = (chain.links.iter())
                    .map(|link| {
                        let arrow = match link.arrow {
                            Arrow::One => "->",
                            Arrow::Row => "->>",
                        };
                        json!({ "arrow": arrow, "place": self.place(&link.place) })
                    })
                    .collect();
                let head = self.place(&chain.head);
                (
                    "chain",
                    json!({ "head": head, "links": links, "after": self.after(&chain.after) }),
                )
            }
            ItemKind::Release(release) => {
                let places: Value = release
                    .places
                    .iter()
                    .map(|place| self.place(place))
                    .collect();
                (
                    "release",
                    json!({ "places": places, "after": self.after(&release.after) }),
                )
            }
            ItemKind::Instance(instance) => {
                let arguments: Value = (instance.arguments.iter())
                    .map(|argument| match argument {
                        Argument::Expr(expr) => self.expr(expr),
                        Argument::Place(place) => self.place(place),
                    })
                    .collect();
                let alias = instance.alias.as_ref().map(|alias| self.place(alias));
                let pattern = self.word(instance.pattern.symbol);
                (
                    "instance",
                    json!({ "pattern": pattern, "arguments": arguments, "alias": alias }),
                )
            }
            ItemKind::Seat(seat) => (
                "seat",
                json!({ "place": self.place(&seat.place), "at": self.pair(&seat.at) }),
            ),
            ItemKind::For(block) => (
                "for",
                json!({
                    "counter": self.word(block.counter.symbol),
                    "range": self.pair(&block.range),
                    "body": self.items(&block.body),
                }),
            ),
            ItemKind::Let(let_) => (
                "let",
                json!({ "name": self.word(let_.name.symbol), "value": self.expr(&let_.value) }),
            ),
            ItemKind::Level(level) => (
                level.verdict.word(),
                json!({ "code": self.word(level.code.symbol), "reason": level.reason }),
            ),
            ItemKind::Yields(name) => ("yields", json!({ "shape": self.word(name.symbol) })),
            ItemKind::Phase(phase) => (
                "phase",
                json!({
                    "name": self.place(&phase.name),
                    "timeout": phase.timeout.as_ref().map(quantity),
                    "body": self.items(&phase.body),
                }),
            ),
            ItemKind::Seed(seed) => (
                "seed",
                json!({ "size": self.pair(&seed.size), "body": self.items(&seed.body) }),
            ),
            ItemKind::Pattern(pattern) => {
                let parameters: Value = (pattern.parameters.iter())
                    .map(|name| self.word(name.symbol))
                    .collect();
                (
                    "pattern",
                    json!({
                        "name": self.word(pattern.name.symbol),
                        "parameters": parameters,
                        "body": self.items(&pattern.body),
                    }),
                )
            }
            ItemKind::Assembly(assembly) => (
                "assembly",
                json!({
                    "name": self.word(assembly.name.symbol),
                    "scene": assembly.scene.map(|scene| self.word(scene.symbol)),
                    "body": self.items(&assembly.body),
                }),
            ),
            ItemKind::Aggregate(aggregate) => (
                "aggregate",
                json!({
                    "name": self.word(aggregate.name.symbol),
                    "scene": aggregate.scene.map(|scene| self.word(scene.symbol)),
                    "size": self.expr(&aggregate.size),
                    "timeout": aggregate.timeout.as_ref().map(quantity),
                }),
            ),
            ItemKind::Shape(shape) => {
                let layers: Value = (shape.layers.iter())
                    .map(|layer| {
                        let row = |cells: &[bool]| -> String {
                            cells
                                .iter()
                                .map(|&cell| if cell { '#' } else { '.' })
                                .collect()
                        };
                        let rows: Value = layer.rows.iter().map(|r| row(&r.cells)).collect();
                        json!({ "heights": self.entry(&layer.heights), "rows": rows })
                    })
                    .collect();
                let at = shape.at.as_ref().map(|at| self.pair(at));
                let name = self.word(shape.name.symbol);
                ("shape", json!({ "name": name, "at": at, "layers": layers }))
            }
            ItemKind::Scene(scene) => (
                "scene",
                json!({
                    "name": self.word(scene.name.symbol),
                    "base": scene.base.map(|base| self.word(base.symbol)),
                    "terms": self.terms(&scene.terms),
                }),
            ),
            ItemKind::Import(import) => ("import", json!({ "path": import.path })),
        };
        let mut object = Map::new();
        object.insert("kind".into(), kind.into());
        object.insert("span".into(), json!([item.span.start, item.span.end]));
        if let Some(docs) = &item.docs.0 {
            object.insert("docs".into(), json!(docs));
        }
        if let Value::Object(fields) = fields {
            object.extend(fields);
        }
        Value::Object(object)
    }

    fn terms(&self, terms: &[Term]) -> Value {
        (terms.iter())
            .map(|term| match term {
                Term::Word(name) => self.word(name.symbol),
                Term::Quantity(value) => quantity(value),
                Term::Range(first, last) => {
                    json!({ "from": quantity(first), "to": quantity(last) })
                }
                Term::Block(terms, _) => self.terms(terms),
            })
            .collect()
    }

    fn after(&self, subjects: &[Subject]) -> Value {
        (subjects.iter())
            .map(|subject| {
                json!({ "release": subject.release, "place": self.place(&subject.place) })
            })
            .collect()
    }

    fn place(&self, place: &Place) -> Value {
        let path: Value = (place.path.iter())
            .map(|segment| {
                let index: Option<Value> = (segment.index.as_deref())
                    .map(|index| index.iter().map(|entry| self.entry(entry)).collect());
                json!({ "name": self.word(segment.name.symbol), "index": index })
            })
            .collect();
        json!({ "path": path, "face": place.face.map(|(face, _)| face) })
    }

    fn entry(&self, entry: &Entry) -> Value {
        match entry {
            Entry::One(expr) => self.expr(expr),
            Entry::Range(first, last) => json!({ "from": self.expr(first), "to": self.expr(last) }),
        }
    }

    fn pair(&self, (first, second): &(Expr, Expr)) -> Value {
        json!([self.expr(first), self.expr(second)])
    }

    fn expr(&self, expr: &Expr) -> Value {
        match &expr.kind {
            ExprKind::Int(value) => (*value).into(),
            ExprKind::Name(symbol) => self.word(*symbol),
            ExprKind::Negate(inner) => json!({ "-": [self.expr(inner)] }),
            ExprKind::Binary(operator, sides) => json!({ operator.sign(): self.pair(sides) }),
        }
    }
}

fn quantity(quantity: &Quantity) -> Value {
    let unit: Value = (quantity.unit.iter())
        .map(|factor| json!({ "symbol": factor.symbol, "power": factor.power }))
        .collect();
    json!({ "value": quantity.value, "unit": unit })
}
