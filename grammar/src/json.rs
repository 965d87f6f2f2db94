//! Tree to JSON.
use serde_json::{Value, json};
use stochc_ir::Json;

use crate::tree::{
    Argument, Arrow, EventReference, Expr, ExprKind, Item, ItemKind, Link, Name, Place, Quantity,
    Segment, Subscript, Term, Tree,
};
use crate::{Symbol, Symbols};

/// The tree with every word written out: a list of items, each an object with its `kind`, its
/// `span` in bytes and what belongs to the kind.
pub fn to_json<'a>(tree: &'a Tree, symbols: &'a Symbols) -> Json<'a> {
    Writer { symbols }.items(&tree.items)
}

#[derive(Clone, Copy)]
struct Writer<'a> {
    symbols: &'a Symbols,
}

impl<'a> Writer<'a> {
    fn items(self, items: &'a [Item]) -> Json<'a> {
        Json::each(items, move |item| self.item(item))
    }

    fn word(self, symbol: Symbol) -> Value {
        self.symbols.word(symbol).into()
    }

    fn item(self, item: &'a Item) -> Json<'a> {
        let word = |symbol| Json::Value(self.word(symbol));
        let (kind, mut fields) = match &item.kind {
            ItemKind::Chain(chain) => (
                "chain",
                vec![
                    ("head", self.place(&chain.head)),
                    (
                        "links",
                        Json::each(&chain.links, move |link| self.link(link)),
                    ),
                    ("after", self.after(&chain.after)),
                ],
            ),
            ItemKind::Release(release) => (
                "release",
                vec![
                    (
                        "places",
                        Json::each(&release.places, move |place| self.place(place)),
                    ),
                    ("after", self.after(&release.after)),
                ],
            ),
            ItemKind::Instance(instance) => {
                let argument = move |argument: &'a Argument| match argument {
                    Argument::Expr(expr) => self.expr(expr).into(),
                    Argument::Place(place) => self.place(place),
                };
                let alias = instance.alias.as_ref().map(|alias| self.place(alias));
                (
                    "instance",
                    vec![
                        ("pattern", word(instance.pattern.symbol)),
                        ("arguments", Json::each(&instance.arguments, argument)),
                        ("alias", alias.unwrap_or(Json::Value(Value::Null))),
                    ],
                )
            }
            ItemKind::Seat(seat) => (
                "seat",
                vec![
                    ("place", self.place(&seat.place)),
                    ("at", self.pair(&seat.at).into()),
                ],
            ),
            ItemKind::For(block) => (
                "for",
                vec![
                    ("counter", word(block.counter.symbol)),
                    ("range", self.pair(&block.range).into()),
                    ("body", self.items(&block.body)),
                ],
            ),
            ItemKind::Let(let_) => (
                "let",
                vec![
                    ("name", word(let_.name.symbol)),
                    ("value", self.expr(&let_.value).into()),
                ],
            ),
            ItemKind::Level(level) => (
                level.verdict.word(),
                vec![
                    ("code", word(level.code.symbol)),
                    ("reason", json!(level.reason).into()),
                ],
            ),
            ItemKind::Yields(name) => ("yields", vec![("shape", word(name.symbol))]),
            ItemKind::Phase(phase) => (
                "phase",
                vec![
                    ("name", self.place(&phase.name)),
                    ("timeout", phase.timeout.as_ref().map(quantity).into()),
                    ("body", self.items(&phase.body)),
                ],
            ),
            ItemKind::Seed(seed) => (
                "seed",
                vec![
                    ("size", self.pair(&seed.size).into()),
                    ("body", self.items(&seed.body)),
                ],
            ),
            ItemKind::Pattern(pattern) => {
                let parameter = move |name: &'a Name| Json::Value(self.word(name.symbol));
                (
                    "pattern",
                    vec![
                        ("name", word(pattern.name.symbol)),
                        ("parameters", Json::each(&pattern.parameters, parameter)),
                        ("body", self.items(&pattern.body)),
                    ],
                )
            }
            ItemKind::Assembly(assembly) => (
                "assembly",
                vec![
                    ("name", word(assembly.name.symbol)),
                    (
                        "scene",
                        assembly.scene.map(|scene| self.word(scene.symbol)).into(),
                    ),
                    ("body", self.items(&assembly.body)),
                ],
            ),
            ItemKind::Aggregate(aggregate) => (
                "aggregate",
                vec![
                    ("name", word(aggregate.name.symbol)),
                    (
                        "scene",
                        aggregate.scene.map(|scene| self.word(scene.symbol)).into(),
                    ),
                    ("size", self.expr(&aggregate.size).into()),
                    ("timeout", aggregate.timeout.as_ref().map(quantity).into()),
                ],
            ),
            ItemKind::Shape(shape) => {
                let row = |cells: &[bool]| -> String {
                    cells
                        .iter()
                        .map(|&cell| if cell { '#' } else { '.' })
                        .collect()
                };
                let layers = Json::each(&shape.layers, move |layer| {
                    let rows = Json::each(&layer.rows, move |it| row(&it.cells).into());
                    Json::object([
                        ("heights", self.entry(&layer.heights).into()),
                        ("rows", rows),
                    ])
                });
                (
                    "shape",
                    vec![
                        ("name", word(shape.name.symbol)),
                        ("at", shape.at.as_ref().map(|at| self.pair(at)).into()),
                        ("layers", layers),
                    ],
                )
            }
            ItemKind::Scene(scene) => (
                "scene",
                vec![
                    ("name", word(scene.name.symbol)),
                    ("base", scene.base.map(|base| self.word(base.symbol)).into()),
                    ("terms", self.terms(&scene.terms)),
                ],
            ),
            ItemKind::Import(import) => ("import", vec![("path", import.path.as_str().into())]),
        };
        fields.push(("kind", kind.into()));
        fields.push(("span", json!([item.span.start, item.span.end]).into()));
        if let Some(docs) = &item.docs.0 {
            fields.push(("docs", Json::each(docs, |line| line.as_str().into())));
        }
        Json::object(fields)
    }

    fn link(self, link: &'a Link) -> Json<'a> {
        let arrow = match link.arrow {
            Arrow::One => "->",
            Arrow::Row => "->>",
        };
        Json::object([("arrow", arrow.into()), ("place", self.place(&link.place))])
    }

    fn terms(self, terms: &'a [Term]) -> Json<'a> {
        Json::each(terms, move |term| match term {
            Term::Word(name) => self.word(name.symbol).into(),
            Term::Quantity(value) => quantity(value).into(),
            Term::Range(first, last) => {
                json!({ "from": quantity(first), "to": quantity(last) }).into()
            }
            Term::Block(terms, _) => self.terms(terms),
        })
    }

    fn after(self, subjects: &'a [EventReference]) -> Json<'a> {
        Json::each(subjects, move |subject| {
            let place = self.place(&subject.place);
            Json::object([("release", subject.release.into()), ("place", place)])
        })
    }

    fn place(self, place: &'a Place) -> Json<'a> {
        let segment = move |segment: &'a Segment| {
            let index: Option<Value> = (segment.index.as_deref())
                .map(|index| index.iter().map(|entry| self.entry(entry)).collect());
            json!({ "name": self.word(segment.name.symbol), "index": index }).into()
        };
        let face = json!(place.face.map(|(face, _)| face));
        Json::object([
            ("path", Json::each(&place.path, segment)),
            ("face", face.into()),
        ])
    }

    fn entry(self, entry: &Subscript) -> Value {
        match entry {
            Subscript::One(expr) => self.expr(expr),
            Subscript::Range(first, last) => {
                json!({ "from": self.expr(first), "to": self.expr(last) })
            }
        }
    }

    fn pair(self, (first, second): &(Expr, Expr)) -> Value {
        json!([self.expr(first), self.expr(second)])
    }

    fn expr(self, expr: &Expr) -> Value {
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
