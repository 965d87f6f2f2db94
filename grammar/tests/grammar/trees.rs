//! Random syntax trees.
use proptest::prelude::*;
use proptest::sample::select;
use stochc_grammar::tree::{
    Aggregate, Argument, ArgumentValue, Arrow, Assembly, Chain, Docs, EventReference, Expectation,
    ExpectedEvent, Expr, ExprKind, For, Function, If, Import, Instance, Item, ItemKind, Layer,
    LayerRow, Let, Link, LintDirective, LintDirectiveKind, Name, Operator, Parameter, Pattern,
    PhaseDeclaration, Place, Placement, Quantity, Release, SceneDeclaration, Seat, Seed, Segment,
    Shape, Subscript, Term, TimeoutHandler, Tree, UnitFactor, YieldsClaim,
};
use stochc_grammar::{Span, Symbols};
use stochc_ir::Face;
use stochc_ir::claim::Relation;

/// Names that look like keywords, units or operators but are ordinary names.
const NAMES: [&str; 17] = [
    "E", "T", "tower", "_", "_b2", "x", "m", "s", "after_", "iffor", "upward", "a9", "allow",
    "deny", "on", "wait", "retry",
];

/// Diagnostic codes. Some of them are also names or keywords.
const CODES: [&str; 6] = ["unused-seed", "a-b2-c_d", "tower", "at", "up", "shape-9"];

/// Words of scenes. They may be keywords, and units if no value precedes them.
const WORDS: [&str; 10] = [
    "block", "faces", "phase", "up", "m", "s", "Pa", "kg", "x", "after",
];

/// Returns the words of all random trees, so that strategies need not pass them along.
pub fn symbols() -> Symbols {
    let mut symbols = Symbols::new();
    for word in NAMES.into_iter().chain(WORDS).chain(CODES) {
        symbols.intern(word);
    }
    symbols
}

fn named(word: &str) -> Name {
    Name {
        symbol: symbols().get(word).unwrap(),
        span: Span::default(),
    }
}

fn name() -> impl Strategy<Value = Name> {
    select(&NAMES[..]).prop_map(named)
}

fn expr() -> impl Strategy<Value = Expr> {
    let kind = |kind| Expr {
        kind,
        span: Span::default(),
    };
    let leaf = prop_oneof![
        any::<i64>()
            .prop_filter("has no literal", |value| *value != i64::MIN)
            .prop_map(ExprKind::Int),
        (-9i64..9).prop_map(ExprKind::Int),
        name().prop_map(|name| ExprKind::Name(name.symbol)),
        select(&Face::ALL[..]).prop_map(ExprKind::Face),
    ]
    .prop_map(kind);
    let operator = select(vec![
        Operator::Add,
        Operator::Subtract,
        Operator::Multiply,
        Operator::Divide,
        Operator::Remainder,
    ]);
    leaf.prop_recursive(5, 24, 2, move |inner| {
        prop_oneof![
            inner.clone().prop_map(move |inner| kind(match inner.kind {
                // A minus before a number is part of the number.
                ExprKind::Int(value) => ExprKind::Int(-value),
                _ => ExprKind::Negate(Box::new(inner)),
            })),
            (operator.clone(), inner.clone(), inner.clone()).prop_map(
                move |(operator, left, right)| kind(ExprKind::Binary(
                    operator,
                    Box::new((left, right))
                ))
            ),
            (
                select(&Function::ALL[..2]),
                prop::collection::vec(inner.clone(), 1..4)
            )
                .prop_map(move |(function, arguments)| kind(ExprKind::Call(function, arguments))),
            (select(&Function::ALL[2..]), inner)
                .prop_map(move |(function, inner)| kind(ExprKind::Call(function, vec![inner]))),
        ]
    })
}

/// Generates a condition.
fn condition() -> impl Strategy<Value = Expr> {
    let kind = |kind| Expr {
        kind,
        span: Span::default(),
    };
    let comparison = select(vec![
        Operator::Equal,
        Operator::NotEqual,
        Operator::Less,
        Operator::LessOrEqual,
        Operator::Greater,
        Operator::GreaterOrEqual,
    ]);
    let leaf = (comparison, expr(), expr()).prop_map(move |(operator, left, right)| {
        kind(ExprKind::Binary(operator, Box::new((left, right))))
    });
    leaf.prop_recursive(3, 12, 2, move |inner| {
        let joined = select(vec![Operator::And, Operator::Or]);
        prop_oneof![
            (inner.clone()).prop_map(move |inner| kind(ExprKind::Not(Box::new(inner)))),
            (joined, inner.clone(), inner).prop_map(move |(operator, left, right)| {
                kind(ExprKind::Binary(operator, Box::new((left, right))))
            }),
        ]
    })
}

fn range() -> impl Strategy<Value = (Expr, Expr)> {
    (expr(), expr())
}

fn entry() -> impl Strategy<Value = Subscript> {
    prop_oneof![
        expr().prop_map(Subscript::One),
        range().prop_map(|(first, last)| Subscript::Range(first, last)),
    ]
}

/// Generates a place without a face.
fn block() -> impl Strategy<Value = Place> {
    let index = prop::option::weighted(0.3, prop::collection::vec(entry(), 1..3));
    let segment = (name(), index).prop_map(|(name, index)| Segment {
        name,
        index: index.map(Vec::into_boxed_slice),
    });
    prop::collection::vec(segment, 1..3).prop_map(|path| Place {
        path: path.into_iter().collect(),
        face: None,
        span: Span::default(),
    })
}

fn face() -> impl Strategy<Value = Option<(Face, Span)>> {
    prop::option::of(select(&Face::ALL[..]).prop_map(|face| (face, Span::default())))
}

fn place() -> impl Strategy<Value = Place> {
    (block(), face()).prop_map(|(place, face)| Place { face, ..place })
}

fn after() -> impl Strategy<Value = Vec<EventReference>> {
    let subject =
        (any::<bool>(), block()).prop_map(|(release, place)| EventReference { release, place });
    prop::collection::vec(subject, 0..3)
}

fn argument() -> impl Strategy<Value = Argument> {
    let value = prop_oneof![
        expr().prop_map(ArgumentValue::Expr),
        // A bare name is an expression.
        place().prop_map(|place| match (&place.path[..], place.face) {
            ([only], None) if only.index.is_none() => ArgumentValue::Expr(Expr {
                kind: ExprKind::Name(only.name.symbol),
                span: Span::default(),
            }),
            _ => ArgumentValue::Place(place),
        }),
    ];
    (prop::option::of(name()), value).prop_map(|(name, value)| Argument { name, value })
}

fn placement() -> impl Strategy<Value = Option<Box<Placement>>> {
    let placement = (
        any::<bool>(),
        prop::option::of(expr()),
        prop::option::of(range()),
    );
    placement.prop_map(|(mirrored, turned, at)| {
        let placement = Placement {
            mirrored,
            turned,
            at,
        };
        (placement != Placement::default()).then(|| Box::new(placement))
    })
}

/// Units with and without prefixes.
const UNITS: [&str; 26] = [
    "m", "mm", "µm", "um", "s", "ms", "min", "kg", "g", "N", "mPa", "L", "rev", "tick", "ticks",
    "%", "deg", "kHz", "GW", "nJ", "V", "cm", "h", "mbar", "cP", "rpm",
];

/// Generates a time. It has one unit, because a name on its line may look like a unit.
fn time() -> impl Strategy<Value = Quantity> {
    quantity().prop_filter_map("a time has a unit", |mut quantity| {
        quantity.unit.truncate(1);
        (!quantity.unit.is_empty()).then_some(quantity)
    })
}

fn quantity() -> impl Strategy<Value = Quantity> {
    let value = prop_oneof![
        -1e3f64..1e3,
        any::<f64>().prop_filter("not a finite number", |value| value.is_finite()),
        (-5i32..500).prop_map(f64::from),
    ];
    let factor = (select(&UNITS[..]), -99i8..=99).prop_map(|(symbol, power)| UnitFactor {
        symbol: symbol.to_owned(),
        power,
    });
    (value, prop::collection::vec(factor, 0..4)).prop_map(|(value, unit)| Quantity {
        value,
        unit,
        span: Span::default(),
    })
}

fn terms() -> impl Strategy<Value = Vec<Term>> {
    let leaf = prop_oneof![
        select(&WORDS[..]).prop_map(|word| Term::Word(named(word))),
        quantity().prop_map(Term::Quantity),
        (quantity(), quantity()).prop_map(|(mut first, second)| {
            if first.unit.is_empty() {
                first.unit.clone_from(&second.unit);
            }
            Term::Range(first, second)
        }),
    ];
    let term = leaf.prop_recursive(3, 12, 4, |inner| {
        (select(&WORDS[..]), prop::collection::vec(inner, 0..4))
            .prop_map(|(_, terms)| Term::Block(terms, Span::default()))
    });
    prop::collection::vec(term, 0..8).prop_map(readable)
}

/// Inserts a word before each block, and before each term that would belong to the preceding value.
fn readable(terms: Vec<Term>) -> Vec<Term> {
    let mut out: Vec<Term> = Vec::new();
    for term in terms {
        let bare = match out.last() {
            Some(Term::Quantity(quantity) | Term::Range(_, quantity)) => quantity.unit.is_empty(),
            _ => false,
        };
        let is_unit = matches!(&term, Term::Word(name)
            if ["m", "s", "Pa", "kg"].map(named).contains(name));
        if (bare && is_unit) || (matches!(term, Term::Block(..)) && !ends_in_word(&out)) {
            out.push(Term::Word(named("block")));
        }
        out.push(match term {
            Term::Block(terms, span) => Term::Block(readable(terms), span),
            other => other,
        });
    }
    out
}

/// Returns whether a block may follow: the grammar requires a word or value before a brace.
fn ends_in_word(terms: &[Term]) -> bool {
    !matches!(terms.last(), None | Some(Term::Block(..)))
}

fn docs() -> impl Strategy<Value = Docs> {
    let line = prop_oneof![
        "[ -~µ\u{202e}\u{200b}\t]{0,12}",
        Just("/// }} release".to_owned()),
        Just(String::new()),
    ]
    .prop_map(|line| line.trim().to_owned());
    prop::option::weighted(0.2, prop::collection::vec(line, 1..3))
        .prop_map(|lines| Docs(lines.map(Box::new)))
}

fn item(kind: impl Strategy<Value = ItemKind> + 'static) -> BoxedStrategy<Item> {
    (docs(), kind)
        .prop_map(|(docs, kind)| Item {
            docs,
            span: Span::default(),
            kind,
        })
        .boxed()
}

fn let_() -> BoxedStrategy<Item> {
    item((name(), expr()).prop_map(|(name, value)| ItemKind::Let(Box::new(Let { name, value }))))
}

fn level() -> BoxedStrategy<Item> {
    let verdict = select(vec![LintDirectiveKind::Allow, LintDirectiveKind::Deny]);
    let level = (verdict, select(&CODES[..]), "[ -!#-~µ/]{0,12}[!-~&&[^\"]]");
    item(level.prop_map(|(verdict, code, reason)| {
        ItemKind::Level(Box::new(LintDirective {
            verdict,
            code: named(code),
            reason,
        }))
    }))
}

/// Generates loops and conditions around some items, nested or not.
fn repeated(inner: BoxedStrategy<Item>) -> BoxedStrategy<Item> {
    inner
        .prop_recursive(3, 12, 3, |inner| {
            let body = prop::collection::vec(inner, 0..3);
            let repeat = (name(), range(), body.clone()).prop_map(|(counter, range, body)| {
                ItemKind::For(Box::new(For {
                    counter,
                    range,
                    body,
                }))
            });
            let branch = (prop::option::of(condition()), any::<bool>(), body).prop_map(
                |(condition, is_else, body)| {
                    ItemKind::If(Box::new(If {
                        is_else: is_else || condition.is_none(),
                        condition,
                        body,
                    }))
                },
            );
            prop_oneof![item(repeat), item(branch)]
        })
        .boxed()
}

fn chain(after: impl Strategy<Value = Vec<EventReference>>) -> impl Strategy<Value = ItemKind> {
    let arrow = select(vec![Arrow::One, Arrow::Row]);
    let links = prop::collection::vec(
        (arrow, place()).prop_map(|(arrow, place)| Link { arrow, place }),
        1..4,
    );
    (place(), links, after)
        .prop_map(|(head, links, after)| ItemKind::Chain(Chain { head, links, after }))
}

/// Generates a statement of a pattern.
fn growth() -> BoxedStrategy<Item> {
    let delay = prop::option::of(time().prop_map(Box::new));
    let release = (prop::collection::vec(block(), 1..3), after(), delay).prop_map(
        |(places, after, delay)| {
            ItemKind::Release(Release {
                places,
                after,
                delay,
            })
        },
    );
    let arguments = prop::collection::vec(argument(), 0..4);
    let instance = (name(), arguments, placement(), prop::option::of(block())).prop_map(
        |(pattern, arguments, placement, alias)| {
            ItemKind::Instance(Box::new(Instance {
                pattern,
                arguments,
                placement,
                alias,
            }))
        },
    );
    repeated(
        prop_oneof![
            3 => item(chain(after())),
            1 => item(release),
            1 => item(time().prop_map(ItemKind::Wait)),
            2 => item(instance),
            1 => let_(),
            1 => level(),
        ]
        .boxed(),
    )
}

fn pattern() -> BoxedStrategy<Item> {
    let parameter =
        (name(), prop::option::of(expr())).prop_map(|(name, default)| Parameter { name, default });
    let parameters = prop::collection::vec(parameter, 0..3);
    let body = prop::collection::vec(growth(), 0..3);
    item(
        (name(), parameters, body).prop_map(|(name, parameters, body)| {
            ItemKind::Pattern(Box::new(Pattern {
                name,
                parameters,
                body,
            }))
        }),
    )
}

fn shape() -> BoxedStrategy<Item> {
    let row = prop::collection::vec(any::<bool>(), 1..6).prop_map(|cells| LayerRow {
        cells,
        span: Span::default(),
    });
    let layer = (entry(), prop::collection::vec(row, 0..3)).prop_map(|(heights, rows)| Layer {
        heights,
        span: Span::default(),
        rows,
    });
    let layers = prop::collection::vec(layer, 0..3);
    item(
        (name(), prop::option::of(range()), layers)
            .prop_map(|(name, at, layers)| ItemKind::Shape(Box::new(Shape { name, at, layers }))),
    )
}

fn timeout_handler((phase, pause, count): (Place, Option<Quantity>, Expr)) -> TimeoutHandler {
    let release = ItemKind::Release(Release {
        delay: None,
        places: vec![phase],
        after: Vec::new(),
    });
    let kinds = [Some(release), pause.map(ItemKind::Wait)]
        .into_iter()
        .flatten();
    let retry = ItemKind::Retry(Box::new(count));
    let bare = |kind| Item {
        docs: Docs(None),
        span: Span::default(),
        kind,
    };
    TimeoutHandler {
        span: Span::default(),
        body: kinds.chain([retry]).map(bare).collect(),
    }
}

fn expectation() -> BoxedStrategy<Item> {
    let relation = || select(&[Relation::AtLeast, Relation::AtMost][..]);
    let event = prop_oneof![
        Just(ExpectedEvent::Complete),
        block().prop_map(ExpectedEvent::Phase),
        (block(), block()).prop_map(|(block, by)| ExpectedEvent::Captured { block, by }),
    ];
    let probability = (event, prop::option::of(quantity()), relation(), quantity()).prop_map(
        |(event, within, relation, bound)| Expectation::Probability {
            event,
            within,
            relation,
            bound,
        },
    );
    let mean = (relation(), quantity())
        .prop_map(|(relation, bound)| Expectation::Mean { relation, bound });
    let faster = (name(), prop::option::of(quantity()))
        .prop_map(|(than, by)| Expectation::Faster { than, by });
    let claim = prop_oneof![probability, mean, faster];
    item(claim.prop_map(|claim| ItemKind::Expect(Box::new(claim))))
}

fn assembly() -> BoxedStrategy<Item> {
    let seat = item(
        (block(), range()).prop_map(|(place, at)| ItemKind::Seat(Box::new(Seat { place, at }))),
    );
    // A pre-attached block waits for nothing.
    let pre_attached = item(chain(Just(Vec::new())));
    let part = prop_oneof![3 => seat, 1 => pre_attached, 1 => let_(), 1 => level()];
    let seats = prop::collection::vec(repeated(part.boxed()), 0..4);
    let seed = item(
        (range(), seats).prop_map(|(size, body)| ItemKind::Seed(Box::new(Seed { size, body }))),
    );
    let claim = item(
        (name(), any::<bool>())
            .prop_map(|(shape, at_least)| ItemKind::Yields(YieldsClaim { shape, at_least })),
    );
    let body = prop::collection::vec(prop_oneof![4 => growth(), 1 => claim], 0..4);
    let count = (1i64..9).prop_map(|value| Expr {
        kind: ExprKind::Int(value),
        span: Span::default(),
    });
    let handler = prop::option::of((block(), prop::option::of(time()), count));
    let phase = item(
        (block(), prop::option::of(quantity()), body, handler).prop_map(
            |(name, timeout, body, handler)| {
                ItemKind::Phase(Box::new(PhaseDeclaration {
                    name,
                    timeout,
                    body,
                    handler: handler.map(|parts| Box::new(timeout_handler(parts))),
                }))
            },
        ),
    );
    let part = prop_oneof![
        2 => repeated(phase),
        1 => expectation(),
        1 => seed,
        1 => let_(),
        1 => pattern(),
        1 => shape(),
        1 => level(),
    ];
    let body = prop::collection::vec(part, 0..4);
    let parameter = (name(), expr()).prop_map(|(name, value)| Let { name, value });
    let parameters = prop::collection::vec(parameter, 0..3);
    item(
        (name(), parameters, prop::option::of(name()), body).prop_map(
            |(name, parameters, scene, body)| {
                ItemKind::Assembly(Box::new(Assembly {
                    name,
                    parameters,
                    scene,
                    body,
                }))
            },
        ),
    )
}

/// Generates a whole file.
pub fn tree() -> impl Strategy<Value = Tree> {
    let scene = item((name(), prop::option::of(name()), terms()).prop_map(
        |(name, base, terms)| ItemKind::Scene(Box::new(SceneDeclaration { name, base, terms })),
    ));
    let import = item("[ -!#-~µ/]{0,12}".prop_map(|path| {
        ItemKind::Import(Box::new(Import {
            path,
            path_span: Span::default(),
        }))
    }));
    let aggregate = item(
        (
            name(),
            prop::option::of(name()),
            expr(),
            prop::option::of(quantity()),
        )
            .prop_map(|(name, scene, size, timeout)| {
                ItemKind::Aggregate(Box::new(Aggregate {
                    name,
                    scene,
                    size,
                    timeout,
                }))
            }),
    );
    let top = prop_oneof![
        1 => aggregate,
        2 => assembly(),
        1 => pattern(),
        1 => shape(),
        2 => scene,
        1 => let_(),
        1 => level(),
        1 => import,
    ];
    prop::collection::vec(top, 0..4).prop_map(|mut items| {
        items.iter_mut().for_each(remove_misplaced_else);
        Tree { items }
    })
}

/// Turns each `else` that does not follow an `if` into an `if`.
fn remove_misplaced_else(item: &mut Item) {
    let body = match &mut item.kind {
        ItemKind::For(block) => &mut block.body,
        ItemKind::If(block) => &mut block.body,
        ItemKind::Phase(block) => &mut block.body,
        ItemKind::Seed(block) => &mut block.body,
        ItemKind::Pattern(block) => &mut block.body,
        ItemKind::Assembly(block) => &mut block.body,
        _ => return,
    };
    let mut follows_if = false;
    for item in body {
        remove_misplaced_else(item);
        if let ItemKind::If(block) = &mut item.kind {
            block.is_else &= follows_if;
            if !block.is_else {
                block.condition.get_or_insert_with(is_zero);
            }
        }
        follows_if = matches!(&item.kind, ItemKind::If(block) if block.condition.is_some());
    }
}

/// Returns the condition `0 == 0`.
fn is_zero() -> Expr {
    let zero = || Expr {
        kind: ExprKind::Int(0),
        span: Span::default(),
    };
    Expr {
        kind: ExprKind::Binary(Operator::Equal, Box::new((zero(), zero()))),
        span: Span::default(),
    }
}
