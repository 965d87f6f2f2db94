//! A scene's words and values to the terms of the model.
mod bond;
mod contact;
mod medium;
#[cfg(test)]
mod sample;

use stochc_grammar::tree::{Name, Quantity, Term};
use stochc_grammar::{Span, Symbols, is_unit};
use stochc_ir::scene::units::Dimension;
use stochc_ir::scene::{
    Agitation, Arrangement, Block, Bond, Contact, Drag, Enclosure, Flow, Fluid, Free, Messages,
    Scene,
};
use stochc_ir::suggest::nearest;

use super::{to_si, unit_meant};
use crate::finding::{Code, Finding, Fix, tell};
use crate::{FileId, Site};

/// The clauses that a scene may have.
const CLAUSES: [&str; 12] = [
    "tick",
    "block",
    "free",
    "enclosure",
    "gravity",
    "fluid",
    "flow",
    "agitation",
    "drag",
    "contact",
    "bond",
    "messages",
];

/// The words inside of clauses.
const WORDS: [&str; 53] = [
    "cube",
    "side",
    "mass",
    "faces",
    "uniform",
    "hemisphere",
    "radius",
    "wall",
    "kicks",
    "speed",
    "rate",
    "restitution",
    "stiffness",
    "damping",
    "friction",
    "attract",
    "pull",
    "align",
    "anchor",
    "centres",
    "gap",
    "within",
    "tilt",
    "hop",
    "loss",
    "ring",
    "sphere",
    "density",
    "viscosity",
    "stir",
    "jets",
    "force",
    "follow",
    "count",
    "flow",
    "nozzle",
    "turbulence",
    "brownian",
    "intensity",
    "length",
    "time",
    "vertical",
    "temperature",
    "reject",
    "suction",
    "hold",
    "depth",
    "impulse",
    "head",
    "supply",
    "valve",
    "passage",
    "seal",
];

/// A scene under construction: what has been said so far.
#[derive(Default)]
struct Draft {
    tick: Option<f64>,
    block: Option<Block>,
    free: Option<Free>,
    enclosure: Option<Enclosure>,
    gravity: Option<f64>,
    fluid: Option<Fluid>,
    flow: Option<Flow>,
    agitation: Option<Agitation>,
    drag: Option<Drag>,
    contact: Option<Contact>,
    bond: Option<Bond>,
    messages: Option<Messages>,
}

impl From<Scene> for Draft {
    fn from(scene: Scene) -> Draft {
        Draft {
            tick: Some(scene.tick),
            block: Some(scene.block),
            free: Some(scene.free),
            enclosure: scene.enclosure,
            gravity: scene.gravity,
            fluid: scene.fluid,
            flow: scene.flow,
            agitation: scene.agitation,
            drag: scene.drag,
            contact: scene.contact,
            bond: scene.bond,
            messages: scene.messages,
        }
    }
}

/// Reads a scene, on top of the one it is derived from.
///
/// `None` if something in it is wrong; every wrong thing is told of.
pub fn read(
    scene: &stochc_grammar::tree::Scene,
    base: Option<Scene>,
    file: FileId,
    symbols: &Symbols,
    findings: &mut Vec<Finding>,
) -> Option<Scene> {
    let before = findings.len();
    let mut draft = base.map_or_else(Draft::default, Draft::from);
    let mut reader = Reader {
        terms: scene.terms.iter().peekable(),
        place: scene.name.span,
        file,
        symbols,
        findings,
    };
    let mut seen: Vec<Name> = Vec::new();
    while let Some(clause) = reader.head(&CLAUSES, "clause of a scene", &seen) {
        reader.once(&mut seen, clause);
        reader.clause(clause, &mut draft);
    }
    reader.medium(&draft, &seen);
    // A clause that is there but wrong has been told of.
    let said = |clause: &str| seen.iter().any(|name| symbols.word(name.symbol) == clause);
    let absent = [
        ("tick", draft.tick.is_none(), "tick 20ms"),
        (
            "block",
            draft.block.is_none(),
            "block cube { side 20cm  mass 1kg  faces 1 }",
        ),
        ("free", draft.free.is_none(), "free 300 uniform"),
        (
            "enclosure",
            draft.enclosure.is_none(),
            "enclosure hemisphere { radius 5m  wall 25 N/m }",
        ),
    ];
    for (clause, is_absent, example) in absent {
        if is_absent && !said(clause) {
            let site = Site {
                file,
                span: scene.name.span,
            };
            tell(
                findings,
                Finding::new(Code::MissingTerm, format!("a scene without `{clause}`"))
                    .label(site, "says nothing of it")
                    .help(format!("add `{example}`")),
            );
        }
    }
    let complete = Scene {
        name: symbols.word(scene.name.symbol).to_owned(),
        tick: draft.tick?,
        block: draft.block?,
        free: draft.free?,
        enclosure: draft.enclosure,
        gravity: draft.gravity,
        fluid: draft.fluid,
        flow: draft.flow,
        agitation: draft.agitation,
        drag: draft.drag,
        contact: draft.contact,
        bond: draft.bond,
        messages: draft.messages,
    };
    (findings.len() == before).then_some(complete)
}

struct Reader<'a, 'f> {
    terms: std::iter::Peekable<std::slice::Iter<'a, Term>>,
    /// The last thing read, for messages about what is missing behind it.
    place: Span,
    file: FileId,
    symbols: &'a Symbols,
    findings: &'f mut Vec<Finding>,
}

impl<'a> Reader<'a, '_> {
    fn clause(&mut self, clause: Name, draft: &mut Draft) {
        match self.word_of(clause) {
            "tick" => {
                draft.tick = self.positive(Dimension::TIME);
            }
            "block" => {
                self.keyword("cube");
                let mut block = Block {
                    side: f64::NAN,
                    mass: f64::NAN,
                    faces: 1,
                };
                self.fields(
                    clause,
                    &["side", "mass", "faces"],
                    &["side", "mass"],
                    |r, field| match field {
                        "side" => block.side = r.positive(Dimension::LENGTH).unwrap_or(f64::NAN),
                        "mass" => block.mass = r.positive(Dimension::MASS).unwrap_or(f64::NAN),
                        _ => block.faces = r.count(1, 5).unwrap_or(1.0) as u8,
                    },
                );
                draft.block = Some(block);
            }
            "free" => {
                let count = self.count(0, 10_000_000);
                let arrangement = match self.kind(&["uniform", "ring"], "arrangement") {
                    Some("uniform") => Some(Arrangement::Uniform),
                    Some(_) => (self.positive(Dimension::LENGTH))
                        .map(|radius| Arrangement::Ring { radius }),
                    None => None,
                };
                draft.free = (count.zip(arrangement)).map(|(count, arrangement)| Free {
                    count: count as u32,
                    arrangement,
                });
            }
            "enclosure" => {
                let kind = self.kind(&["hemisphere", "sphere"], "enclosure");
                let (mut radius, mut wall) = (None, None);
                let all = ["radius", "wall"];
                self.fields(clause, &all, &all, |r, field| match field {
                    "radius" => radius = r.positive(Dimension::LENGTH),
                    _ => wall = r.positive(Dimension::STIFFNESS),
                });
                draft.enclosure = match (kind, radius.zip(wall)) {
                    (Some("sphere"), Some((radius, wall))) => {
                        Some(Enclosure::Sphere { radius, wall })
                    }
                    (Some(_), Some((radius, wall))) => Some(Enclosure::Hemisphere { radius, wall }),
                    _ => None,
                };
            }
            "gravity" => draft.gravity = self.positive(Dimension::ACCELERATION),
            "fluid" => draft.fluid = self.fluid(clause),
            "flow" => draft.flow = self.flow(clause),
            "agitation" => draft.agitation = self.agitation(clause),
            "drag" => {
                let mut rate = None;
                self.fields(clause, &["rate"], &["rate"], |r, _| {
                    rate = r.positive(Dimension::RATE);
                });
                draft.drag = rate.map(|rate| Drag { rate });
            }
            "contact" => draft.contact = self.contact(clause),
            "bond" => draft.bond = self.bond(clause),
            "messages" => {
                let (mut hop, mut loss) = (None, None);
                self.fields(clause, &["hop", "loss"], &["hop"], |r, field| match field {
                    "hop" => hop = r.whole(Dimension::TICKS, 0, 1_000_000),
                    _ => loss = r.between(Dimension::NUMBER, 0.0, 1.0),
                });
                let hop = hop.map(|hop| hop as u32);
                draft.messages = hop.map(|hop| Messages { hop, loss });
            }
            _ => {}
        }
    }

    /// The fields between a clause's braces, in any order.
    fn fields(
        &mut self,
        clause: Name,
        known: &[&str],
        needed: &[&str],
        mut read: impl FnMut(&mut Reader<'a, '_>, &'a str),
    ) {
        let Some(Term::Block(terms, span)) = self.terms.peek() else {
            return self.without_braces(clause, known);
        };
        self.terms.next();
        let mut inner = Reader {
            terms: terms.iter().peekable(),
            place: *span,
            file: self.file,
            symbols: self.symbols,
            findings: &mut *self.findings,
        };
        let mut seen: Vec<Name> = Vec::new();
        while let Some(field) = inner.head(known, "field", &seen) {
            inner.once(&mut seen, field);
            let word = inner.word_of(field);
            read(&mut inner, word);
        }
        for &field in needed {
            if !seen.iter().any(|name| self.word_of(*name) == field) {
                let finding = self.without(clause, field);
                tell(self.findings, finding);
            }
        }
        self.place = *span;
    }

    /// Tells that a clause has no braces, and what might stand between them.
    fn without_braces(&mut self, clause: Name, fields: &[&str]) {
        let word = self.word_of(clause);
        let finding = Finding::new(Code::MissingTerm, format!("`{word}` without its braces"))
            .label(self.site(clause.span), "what of it?")
            .help(format!("write `{word} ... {{ {} }}`", fields.join(" ... ")));
        let symbols = self.symbols;
        let is = |term: &Term, words: &[&str]| matches!(term, Term::Word(name) if words.contains(&symbols.word(name.symbol)));
        if !(self.terms.peek()).is_some_and(|term| is(term, fields)) {
            return tell(self.findings, finding);
        }
        let behind = self.site(Span::new(self.place.end, self.place.end));
        tell(
            self.findings,
            finding.fix(Fix::replace(behind, " {", "write the `{`")),
        );
        // Its fields stand there without it.
        while self.terms.next_if(|term| !is(term, &CLAUSES)).is_some() {}
    }

    /// That a clause has none of a field that it needs.
    fn without(&self, clause: Name, field: &str) -> Finding {
        let word = self.word_of(clause);
        Finding::new(Code::MissingTerm, format!("`{word}` without `{field}`"))
            .label(self.site(clause.span), format!("needs `{field}`"))
    }

    /// The next word, which has to be one of `known`; skips what is none, and tells of it once.
    fn head(&mut self, known: &[&str], noun: &str, said: &[Name]) -> Option<Name> {
        let mut told = false;
        loop {
            let term = self.terms.next()?;
            if let Term::Word(name) = term {
                self.place = name.span;
                let word = self.word_of(*name);
                if known.contains(&word) {
                    return Some(*name);
                }
                if !told {
                    let site = self.site(name.span);
                    let title = format!("`{word}` is no {noun}");
                    let mut meant = nearest(word, known);
                    if let Some(meant) = &mut meant {
                        // Nothing is said twice.
                        meant.clear &= !said.iter().any(|name| self.word_of(*name) == meant.word);
                    }
                    let finding = Finding::new(Code::UnknownTerm, title)
                        .label(site, "not known here")
                        .suggest(site, meant, || format!("known are {}", known.join(", ")));
                    tell(self.findings, finding);
                }
            } else if !told {
                let span = span(term);
                let help = format!("expected one of {}", known.join(", "));
                let title = format!("expected a {noun}");
                self.tell(Code::UnknownTerm, title, span, "does not belong here", help);
            }
            told = true;
        }
    }

    /// A word that has to stand here.
    fn keyword(&mut self, word: &str) {
        self.kind(&[word], word);
    }

    /// One of the words for the kind of something.
    fn kind(&mut self, known: &[&str], noun: &str) -> Option<&'a str> {
        let (expected, help) = match known {
            [only] => (
                format!("`{only}`"),
                format!("`{only}` is the only kind there is"),
            ),
            _ => {
                let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) {
                    "an"
                } else {
                    "a"
                };
                (
                    format!("{article} {noun}"),
                    format!("known are {}", known.join(", ")),
                )
            }
        };
        let (found, span) = match self.terms.peek() {
            Some(Term::Word(name)) => {
                let found = self.word_of(*name);
                if known.contains(&found) {
                    self.place = name.span;
                    self.terms.next();
                    return Some(found);
                }
                self.terms.next();
                let site = self.site(name.span);
                let title = format!("expected {expected}, found `{found}`");
                let finding = Finding::new(Code::UnknownTerm, title)
                    .label(site, "here")
                    .help(help);
                let fix = match (nearest(found, known), known) {
                    (Some(meant), _) => Some(Fix::word(site, &meant)),
                    (None, [only]) => {
                        Some(Fix::replace(site, *only, format!("write `{only}`")).unsafe_if(true))
                    }
                    _ => None,
                };
                let finding = match fix {
                    Some(fix) => finding.fix(fix),
                    None => finding,
                };
                tell(self.findings, finding);
                return None;
            }
            Some(term) => ("something else", span(term)),
            None => ("nothing", self.place),
        };
        let title = format!("expected {expected}, found {found}");
        self.tell(Code::UnknownTerm, title, span, "here", help);
        None
    }

    /// The same, of a clause whose fields depend on it: those of an unknown kind are passed over.
    fn kind_of_clause(&mut self, known: &[&str], noun: &str) -> Option<&'a str> {
        let kind = self.kind(known, noun);
        if kind.is_none() && matches!(self.terms.peek(), Some(Term::Block(..))) {
            self.terms.next();
        }
        kind
    }

    fn next_is(&mut self, word: &str) -> bool {
        let Some(&&Term::Word(name)) = self.terms.peek() else {
            return false;
        };
        let is_next = self.word_of(name) == word;
        if is_next {
            self.place = name.span;
            self.terms.next();
        }
        is_next
    }

    fn quantity(&mut self, dimension: Dimension) -> Option<&'a Quantity> {
        if let Some(Term::Quantity(quantity)) = self.terms.peek() {
            self.terms.next();
            self.place = quantity.span;
            return Some(quantity);
        }
        if let Some(&&Term::Word(name)) = self.terms.peek()
            && self.is_unit(name)
        {
            self.terms.next();
            let word = self.word_of(name);
            let help = format!("write the number before it, such as `2 {word}`");
            let title = "a unit without its number".to_owned();
            self.tell(Code::MissingTerm, title, name.span, "how much?", help);
            return None;
        }
        let here = self.terms.peek().map_or(self.place, |term| span(term));
        let title = format!("expected {}", dimension.noun());
        tell(
            self.findings,
            Finding::new(Code::MissingTerm, title).label(self.site(here), "a value belongs here"),
        );
        None
    }

    fn value(&mut self, quantity: &Quantity, dimension: Dimension) -> Option<f64> {
        let (value, found) = to_si(quantity);
        if found == dimension {
            return Some(value);
        }
        let title = format!("expected {}", dimension.noun());
        if let (Dimension::NUMBER, Some(&&Term::Word(name))) = (found, self.terms.peek())
            && name.span.start <= quantity.span.end + 1
            && !self.is_known(name)
        {
            self.terms.next();
            let word = self.word_of(name);
            let site = self.site(name.span);
            let finding = Finding::new(Code::WrongDimension, title)
                .label(site, format!("`{word}` is no unit"))
                .suggest(site, unit_meant(word), || {
                    "units are those of the SI, with prefixes such as `m` and `k`, and min, h, \
                     L, rev, deg and ticks"
                        .to_owned()
                });
            tell(self.findings, finding);
            return None;
        }
        let label = match found {
            Dimension::NUMBER => "has no unit".to_owned(),
            other => match other.noun() {
                "a value of another kind" => "has another unit".to_owned(),
                noun => format!("is {}", noun.split(',').next().unwrap_or(noun)),
            },
        };
        let site = self.site(quantity.span);
        tell(
            self.findings,
            Finding::new(Code::WrongDimension, title).label(site, label),
        );
        None
    }

    fn positive(&mut self, dimension: Dimension) -> Option<f64> {
        self.between(dimension, f64::MIN_POSITIVE, f64::MAX)
    }

    fn between(&mut self, dimension: Dimension, least: f64, most: f64) -> Option<f64> {
        let quantity = self.quantity(dimension)?;
        let value = self.value(quantity, dimension)?;
        if (least..=most).contains(&value) {
            return Some(value);
        }
        let rule = match (least, most) {
            (f64::MIN_POSITIVE, f64::MAX) => "must be more than 0".to_owned(),
            (least, f64::MAX) => format!("must be at least {least}"),
            (_, std::f64::consts::FRAC_PI_2) => "must be more than 0 and at most 90 deg".to_owned(),
            (least, most) => format!("must be from {least} to {most}"),
        };
        let site = self.site(quantity.span);
        let title = "a value out of its range";
        tell(
            self.findings,
            Finding::new(Code::WrongValue, title).label(site, rule),
        );
        None
    }

    fn count(&mut self, least: u32, most: u32) -> Option<f64> {
        self.whole(Dimension::NUMBER, least, most)
    }

    fn whole(&mut self, dimension: Dimension, least: u32, most: u32) -> Option<f64> {
        let quantity = self.quantity(dimension)?;
        let value = self.value(quantity, dimension)?;
        if value.fract() == 0.0 && (f64::from(least)..=f64::from(most)).contains(&value) {
            return Some(value);
        }
        let site = self.site(quantity.span);
        tell(
            self.findings,
            Finding::new(Code::WrongValue, "a value out of its range").label(
                site,
                format!("must be a whole number from {least} to {most}"),
            ),
        );
        None
    }

    fn range(&mut self, dimension: Dimension) -> Option<(f64, f64)> {
        let Some(Term::Range(first, last)) = self.terms.peek() else {
            let value = self.between(dimension, 0.0, f64::MAX)?;
            return Some((value, value));
        };
        self.terms.next();
        self.place = last.span;
        let (low, high) = (self.value(first, dimension)?, self.value(last, dimension)?);
        if 0.0 <= low && low <= high {
            return Some((low, high));
        }
        let site = self.site(first.span.to(last.span));
        tell(
            self.findings,
            Finding::new(Code::WrongValue, "a range that is empty or negative")
                .label(site, "from small to large, and not below 0"),
        );
        None
    }

    fn once(&mut self, seen: &mut Vec<Name>, name: Name) {
        if let Some(old) = seen.iter().find(|old| old.symbol == name.symbol) {
            let word = self.word_of(name);
            let finding = Finding::new(Code::DuplicateTerm, format!("`{word}` is given twice"))
                .label(self.site(name.span), "given again")
                .label(self.site(old.span), "first given here")
                .help("remove one of the two");
            tell(self.findings, finding);
        }
        seen.push(name);
    }

    fn tell(&mut self, code: Code, title: String, span: Span, label: &str, help: String) {
        let site = self.site(span);
        tell(
            self.findings,
            Finding::new(code, title).label(site, label).help(help),
        );
    }

    fn word_of(&self, name: Name) -> &'a str {
        self.symbols.word(name.symbol)
    }

    /// Whether a word means something in a scene.
    fn is_known(&self, name: Name) -> bool {
        let word = self.word_of(name);
        CLAUSES.contains(&word) || WORDS.contains(&word)
    }

    fn is_unit(&self, name: Name) -> bool {
        !self.is_known(name) && is_unit(self.word_of(name))
    }

    fn site(&self, span: Span) -> Site {
        Site {
            file: self.file,
            span,
        }
    }
}

fn span(term: &Term) -> Span {
    match term {
        Term::Word(name) => name.span,
        Term::Quantity(quantity) => quantity.span,
        Term::Range(first, last) => first.span.to(last.span),
        Term::Block(_, span) => *span,
    }
}
