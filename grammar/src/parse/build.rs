//! Builds the items of the tree from pieces.
use pest::iterators::Pair;
use smallvec::SmallVec;
use stochc_ir::Face;
use stochc_ir::claim::Relation;

use super::Rule;
use super::expr::two;
use super::open_block::{Mode, OpenBlockContent};
use super::parser::Parser;
use super::spans::{end_of, span_of};
use crate::Span;
use crate::error::SyntaxErrorKind;
use crate::tree::{
    Aggregate, Argument, ArgumentValue, Arrow, Assembly, Chain, EventReference, Expectation,
    ExpectedEvent, Expr, For, If, Import, Instance, Item, ItemKind, Let, Link, LintDirective,
    LintDirectiveKind, Name, Parameter, Pattern, PhaseDeclaration, Place, Placement, Quantity,
    Release, SceneDeclaration, Seat, Seed, Segment, Shape, TimeoutHandler, YieldsClaim,
};

impl Parser<'_, '_> {
    /// Builds a piece and adds it to the block that contains it.
    pub fn build(&mut self, pair: Pair<'_, Rule>, base: usize) {
        if self.mode() != Mode::Block {
            return self.scene_or_shape_piece(pair, base);
        }
        let mut span = span_of(&pair, base);
        span.end = end_of(&pair, base);
        let rule = pair.as_rule();
        let kind = match rule {
            Rule::chain => ItemKind::Chain(self.chain(pair, base)),
            Rule::release => ItemKind::Release(self.release(pair, base)),
            Rule::instance if self.is_list(&pair, base) => return,
            Rule::instance => ItemKind::Instance(Box::new(self.instance(pair, base))),
            Rule::seat => ItemKind::Seat(Box::new(self.seat(pair, base))),
            Rule::level => ItemKind::Level(Box::new(self.level(pair, base))),
            Rule::yields => ItemKind::Yields(YieldsClaim {
                at_least: pair
                    .clone()
                    .into_inner()
                    .any(|part| part.as_rule() == Rule::kw_least),
                shape: self.first_name(pair, base),
            }),
            Rule::wait => ItemKind::Wait(self.wait(pair, base)),
            Rule::retry => ItemKind::Retry(Box::new(two(self.exprs(pair, base)).0)),
            Rule::expect => ItemKind::Expect(Box::new(self.expectation(pair, base))),
            Rule::let_ => ItemKind::Let(Box::new(self.let_(pair, base))),
            Rule::aggregate => ItemKind::Aggregate(Box::new(self.aggregate(pair, base))),
            Rule::import => ItemKind::Import(Box::new(import(pair, base))),
            Rule::for_head => ItemKind::For(Box::new(self.for_head(pair, base))),
            Rule::if_head => ItemKind::If(Box::new(self.if_head(pair, base))),
            Rule::phase_head => ItemKind::Phase(Box::new(self.phase_head(pair, base))),
            Rule::handler_head => ItemKind::Handler(Box::new(TimeoutHandler {
                span,
                body: Vec::new(),
            })),
            Rule::seed_head => ItemKind::Seed(Box::new(self.seed_head(pair, base))),
            Rule::pattern_head => ItemKind::Pattern(Box::new(self.pattern_head(pair, base))),
            Rule::assembly_head => ItemKind::Assembly(Box::new(self.assembly_head(pair, base))),
            Rule::scene_head => ItemKind::Scene(Box::new(self.scene_head(pair, base))),
            _ => ItemKind::Shape(Box::new(self.shape_head(pair, base))),
        };
        let item = Item {
            docs: self.take_docs(),
            span,
            kind,
        };
        self.check_place_of(&item);
        match rule {
            Rule::scene_head => {
                self.open(OpenBlockContent::Scene(Box::new(item), Vec::new()), span)
            }
            Rule::shape_head => self.open(OpenBlockContent::Shape(Box::new(item)), span),
            Rule::for_head
            | Rule::if_head
            | Rule::phase_head
            | Rule::handler_head
            | Rule::seed_head
            | Rule::pattern_head
            | Rule::assembly_head => self.open(OpenBlockContent::Items(Box::new(item)), span),
            _ => self.keep(item),
        }
    }

    /// Reports a list in parentheses that was parsed as an instance: `after (A, B)`. Returns
    /// whether the piece is such a list.
    fn is_list(&mut self, pair: &Pair<'_, Rule>, base: usize) -> bool {
        let mut parts = pair.clone().into_inner();
        let word = parts.next().map_or("", |name| name.as_str());
        if !matches!(word, "after" | "release" | "yields") {
            return false;
        }
        let is_paren =
            |part: &Pair<'_, Rule>| matches!(part.as_rule(), Rule::paren_open | Rule::paren_close);
        let parens = parts.filter(is_paren).map(|paren| span_of(&paren, base));
        let span = parens.reduce(Span::to).unwrap_or_default();
        let word = word.to_owned();
        self.docs.clear();
        self.error(SyntaxErrorKind::Parentheses { word }, span);
        true
    }

    /// Reports an item that is not valid in the open block.
    fn check_place_of(&mut self, item: &Item) {
        let outer = match self.frames.last().map(|frame| &frame.content) {
            None => None,
            Some(OpenBlockContent::Items(outer)) => Some(outer),
            Some(_) => return,
        };
        // Loops and conditions can contain the same items as the block around them.
        let outer = match outer {
            Some(inner) if inner.is_transparent() => {
                self.frames
                    .iter()
                    .rev()
                    .find_map(|frame| match &frame.content {
                        OpenBlockContent::Items(outer) if !outer.is_transparent() => Some(outer),
                        _ => None,
                    })
            }
            other => other,
        };
        use ItemKind as K;
        let (fits, belongs) = match (&item.kind, outer.map(|outer| &outer.kind)) {
            // Pre-attached blocks.
            (K::Chain(_), Some(K::Seed(_))) => (true, ""),
            // The captures of the phase.
            (K::Release(_), Some(K::Handler(_))) => (true, ""),
            (K::Retry(_), outer) => (matches!(outer, Some(K::Handler(_))), "`on timeout`"),
            (K::Wait(_), outer) => (
                matches!(outer, Some(K::Handler(_) | K::Phase(_) | K::Pattern(_))),
                "a phase, a pattern or `on timeout`",
            ),
            (K::Handler(_), _) => (
                self.follows_phase(),
                "the line of the `}` that ends a phase",
            ),
            (K::Let(_) | K::Level(_) | K::For(_) | K::If(_), Some(K::Handler(_))) => {
                (false, "a phase")
            }
            (K::Chain(_) | K::Release(_), outer) => (
                matches!(outer, Some(K::Phase(_) | K::Pattern(_))),
                "a phase or a pattern",
            ),
            (K::Instance(_), outer) => (outer.is_some(), "an assembly or a pattern"),
            (K::Yields(_), outer) => (matches!(outer, Some(K::Phase(_))), "a phase"),
            (K::Seat(_), outer) => (
                matches!(outer, Some(K::Seed(_) | K::Pattern(_))),
                "`seed plate` or a pattern",
            ),
            (K::If(block), _) if block.is_else && !self.follows_if() => {
                (false, "the line of the `}` that ends an `if`")
            }
            (K::For(_) | K::If(_), outer) => (outer.is_some(), "an assembly"),
            (K::Let(_) | K::Level(_), _) => (true, ""),
            (K::Phase(_), outer) => (
                matches!(outer, Some(K::Assembly(_) | K::Pattern(_))),
                "an assembly or a pattern",
            ),
            (K::Seed(_) | K::Expect(_), outer) => {
                (matches!(outer, Some(K::Assembly(_))), "an assembly")
            }
            (K::Pattern(_) | K::Shape(_), outer) => (
                matches!(outer, None | Some(K::Assembly(_))),
                "the file or an assembly, outside of phases",
            ),
            (K::Assembly(_) | K::Aggregate(_) | K::Scene(_) | K::Import(_), outer) => {
                (outer.is_none(), "the file, outside of every block")
            }
        };
        let mut wrong = (!fits).then(|| (item.noun(), item.span, belongs));
        if let (K::Chain(chain), Some(K::Seed(_))) = (&item.kind, outer.map(|outer| &outer.kind))
            && let Some(first) = chain.after.first()
        {
            // Pre-attached blocks exist before any event.
            wrong = Some(("an `after`", first.place.span, "a phase"));
        }
        if let Some((what, span, belongs)) = wrong {
            let within = self.frames.last().map_or("the file", |frame| frame.noun());
            let within = match outer.map(|outer| &outer.kind) {
                _ if within != "a loop" => within,
                Some(K::Assembly(_)) => "a loop outside of every phase",
                Some(K::Phase(_)) => "a loop of a phase",
                Some(K::Pattern(_)) => "a loop of a pattern",
                Some(K::Seed(_)) => "a loop of a seed plate",
                _ => within,
            };
            self.error(
                SyntaxErrorKind::Misplaced {
                    what,
                    within,
                    belongs,
                    is_read: true,
                },
                span,
            );
        }
    }

    /// Returns whether the last item is an `if`, or an `else` with a condition.
    fn follows_if(&self) -> bool {
        let items = self.frames.last().map_or(&self.root, |frame| &frame.body);
        matches!(items.last().map(|last| &last.kind),
            Some(ItemKind::If(block)) if block.condition.is_some())
    }

    /// Returns whether the last item is a phase without a handler.
    fn follows_phase(&self) -> bool {
        let items = self.frames.last().map_or(&self.root, |frame| &frame.body);
        matches!(items.last().map(|last| &last.kind),
            Some(ItemKind::Phase(phase)) if phase.handler.is_none())
    }

    pub fn name(&mut self, pair: &Pair<'_, Rule>, base: usize) -> Name {
        let name = self.word(pair, base);
        if self.symbols.is_reserved(name.symbol) {
            let word = pair.as_str().to_owned();
            self.error(SyntaxErrorKind::ReservedWord { word }, name.span);
        }
        name
    }

    /// Builds a name from a word, without checking for keywords.
    pub fn word(&mut self, pair: &Pair<'_, Rule>, base: usize) -> Name {
        Name {
            symbol: self.symbols.intern(pair.as_str()),
            span: span_of(pair, base),
        }
    }

    fn names(&mut self, pair: Pair<'_, Rule>, base: usize) -> SmallVec<[Name; 4]> {
        pair.into_inner()
            .filter(|pair| pair.as_rule() == Rule::name)
            .map(|pair| self.name(&pair, base))
            .collect()
    }

    fn first_name(&mut self, pair: Pair<'_, Rule>, base: usize) -> Name {
        let span = span_of(&pair, base);
        let names = self.names(pair, base);
        names.first().copied().unwrap_or_else(|| Name {
            symbol: self.symbols.intern(""),
            span,
        })
    }

    pub fn place(&mut self, pair: Pair<'_, Rule>, base: usize) -> Place {
        let span = span_of(&pair, base);
        let mut place = Place {
            path: SmallVec::new(),
            face: None,
            span,
        };
        for part in pair.into_inner() {
            if let Some((face, at)) = place.face {
                let is_block =
                    part.as_rule() == Rule::name && Face::from_word(part.as_str()).is_none();
                if place.path.is_empty() && !is_block {
                    place.path.push(self.reserved(face.word(), at));
                    place.face = None;
                } else {
                    let hint = "write the face after the name of its block, as in `A.up`";
                    self.error(SyntaxErrorKind::FaceMisused { hint }, at);
                    if place.path.is_empty() {
                        let name = self.word(&part, base);
                        place.path.push(Segment { name, index: None });
                    }
                    return place;
                }
            }
            if part.as_rule() == Rule::name {
                let name = self.word(&part, base);
                if !self.symbols.is_reserved(name.symbol) {
                    place.path.push(Segment { name, index: None });
                } else if let Some(face) = Face::from_word(part.as_str()) {
                    place.face = Some((face, name.span));
                } else {
                    place.path.push(self.reserved(part.as_str(), name.span));
                }
            } else {
                let entries = part
                    .into_inner()
                    .filter(|pair| matches!(pair.as_rule(), Rule::range | Rule::expr))
                    .map(|pair| self.entry(pair, base))
                    .collect::<Vec<_>>();
                if let Some(last) = place.path.last_mut() {
                    last.index = Some(entries.into_boxed_slice());
                }
            }
        }
        place
    }

    /// Builds a `place` that names blocks. A face in the place is reported as an error.
    fn block(&mut self, pair: Pair<'_, Rule>, base: usize) -> Place {
        let place = self.place(pair, base);
        if let Some((_, span)) = place.face {
            let hint = "write the block without its face";
            self.error(SyntaxErrorKind::FaceMisused { hint }, span);
        } else {
            self.check_named(&place);
        }
        place
    }

    /// Builds a `place` that declares a new name.
    fn new_place(&mut self, pair: Pair<'_, Rule>, base: usize) -> Place {
        let mut place = self.place(pair, base);
        if let Some((face, span)) = place.face.take() {
            if place.path.is_empty() {
                place.path.push(self.reserved(face.word(), span));
            } else {
                let hint = "write the name without a face";
                self.error(SyntaxErrorKind::FaceMisused { hint }, span);
            }
        }
        place
    }

    /// Builds a name from a keyword, and reports the keyword as an error.
    fn reserved(&mut self, word: &str, span: Span) -> Segment {
        let symbol = self.symbols.intern(word);
        let word = word.to_owned();
        self.error(SyntaxErrorKind::ReservedWord { word }, span);
        Segment {
            name: Name { symbol, span },
            index: None,
        }
    }

    fn check_named(&mut self, place: &Place) {
        if place.path.is_empty() {
            let hint = "write the block's name and a dot before the face, as in `A.up`";
            self.error(SyntaxErrorKind::FaceMisused { hint }, place.span);
        }
    }

    fn chain(&mut self, pair: Pair<'_, Rule>, base: usize) -> Chain {
        let mut head = None;
        let mut links: Vec<Link> = Vec::new();
        let mut after = Vec::new();
        let mut arrow = Arrow::One;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::place => {
                    let place = self.place(part, base);
                    self.check_named(&place);
                    if head.is_none() {
                        head = Some(place);
                    } else {
                        links.push(Link { arrow, place });
                    }
                }
                Rule::arrow if part.as_str() == "->" => arrow = Arrow::One,
                Rule::arrow => arrow = Arrow::Row,
                _ => after = self.after_of_chain(part, base),
            }
        }
        let head = head.unwrap_or(Place {
            path: SmallVec::new(),
            face: None,
            span: Span::default(),
        });
        Chain { head, links, after }
    }

    /// Builds the `after` of a capture. A time in it is reported as an error.
    fn after_of_chain(&mut self, pair: Pair<'_, Rule>, base: usize) -> Vec<EventReference> {
        if let Some(time) = delay(&pair) {
            let kind = SyntaxErrorKind::Misplaced {
                what: "a time in `after`",
                within: "a capture",
                belongs: "a `release`",
                is_read: true,
            };
            self.error(kind, span_of(&time, base));
        }
        self.after(pair, base)
    }

    fn after(&mut self, pair: Pair<'_, Rule>, base: usize) -> Vec<EventReference> {
        let mut subjects = Vec::new();
        for subject in pair
            .into_inner()
            .filter(|pair| pair.as_rule() == Rule::subject)
        {
            let mut release = false;
            for part in subject.into_inner() {
                match part.as_rule() {
                    Rule::place => {
                        let place = self.block(part, base);
                        subjects.push(EventReference { release, place });
                    }
                    _ => release = true,
                }
            }
        }
        subjects
    }

    fn release(&mut self, pair: Pair<'_, Rule>, base: usize) -> Release {
        let mut release = Release {
            places: Vec::new(),
            after: Vec::new(),
            delay: None,
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::place => {
                    let place = self.block(part, base);
                    release.places.push(place);
                }
                Rule::after => {
                    let delay = delay(&part).map(|time| Box::new(self.quantity(time, base)));
                    release.delay = delay;
                    release.after = self.after(part, base);
                }
                _ => {}
            }
        }
        release
    }

    fn instance(&mut self, pair: Pair<'_, Rule>, base: usize) -> Instance {
        let mut pattern = None;
        let mut arguments = Vec::new();
        let mut placement = None;
        let mut alias = None;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::name => pattern = Some(self.name(&part, base)),
                Rule::argument => arguments.extend(self.argument(part, base)),
                Rule::placement => placement = Some(Box::new(self.placement(part, base))),
                Rule::place => alias = Some(self.new_place(part, base)),
                _ => {}
            }
        }
        let pattern = pattern.unwrap_or_else(|| Name {
            symbol: self.symbols.intern(""),
            span: Span::default(),
        });
        Instance {
            pattern,
            arguments,
            placement,
            alias,
        }
    }

    fn placement(&mut self, pair: Pair<'_, Rule>, base: usize) -> Placement {
        let mut placement = Placement::default();
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::turned => placement.turned = self.exprs(part, base).pop(),
                Rule::point => placement.at = Some(two(self.exprs(part, base))),
                _ => placement.mirrored = true,
            }
        }
        placement
    }

    fn argument(&mut self, pair: Pair<'_, Rule>, base: usize) -> Option<Argument> {
        let mut name = None;
        for part in pair.into_inner() {
            let value = match part.as_rule() {
                Rule::name => {
                    name = Some(self.name(&part, base));
                    continue;
                }
                Rule::equals => continue,
                Rule::expr => ArgumentValue::Expr(self.expr(part, base)),
                _ => ArgumentValue::Place(self.place(part, base)),
            };
            // The lookahead after an expression leaves no pair.
            return Some(Argument { name, value });
        }
        None
    }

    fn seat(&mut self, pair: Pair<'_, Rule>, base: usize) -> Seat {
        let mut place = None;
        let mut at = Vec::new();
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::place => place = Some(self.new_place(part, base)),
                Rule::expr => at.push(self.expr(part, base)),
                _ => {}
            }
        }
        let place = place.unwrap_or(Place {
            path: SmallVec::new(),
            face: None,
            span: Span::default(),
        });
        Seat { place, at: two(at) }
    }

    fn level(&mut self, pair: Pair<'_, Rule>, base: usize) -> LintDirective {
        let mut level = LintDirective {
            verdict: LintDirectiveKind::Allow,
            code: Name {
                symbol: self.symbols.intern(""),
                span: span_of(&pair, base),
            },
            reason: String::new(),
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::code => level.code = self.word(&part, base),
                Rule::string => part
                    .as_str()
                    .trim_matches('"')
                    .clone_into(&mut level.reason),
                _ if part.as_str() == LintDirectiveKind::Deny.word() => {
                    level.verdict = LintDirectiveKind::Deny
                }
                _ => {}
            }
        }
        if level.reason.trim().is_empty() {
            self.error(SyntaxErrorKind::MissingReason, level.code.span);
        }
        level
    }

    fn expectation(&mut self, pair: Pair<'_, Rule>, base: usize) -> Expectation {
        let mut words = pair.into_inner();
        let claim = words.find(|part| part.as_rule() != Rule::kw_expect);
        let claim = claim.expect("the grammar has a claim after `expect`");
        let rule = claim.as_rule();
        let mut event = ExpectedEvent::Complete;
        let mut name = None;
        let mut quantities = Vec::new();
        let mut relation = Relation::AtLeast;
        for part in claim.into_inner() {
            match part.as_rule() {
                Rule::expected_event => event = self.expected_event(part, base),
                Rule::quantity => quantities.push(self.quantity(part, base)),
                Rule::relation if part.as_str() == "<=" => relation = Relation::AtMost,
                Rule::name => name = Some(self.name(&part, base)),
                _ => {}
            }
        }
        let last = quantities.pop();
        match (rule, last, name) {
            (Rule::expected_mean, Some(bound), _) => Expectation::Mean { relation, bound },
            (Rule::expected_probability, Some(bound), _) => Expectation::Probability {
                event,
                within: quantities.pop(),
                relation,
                bound,
            },
            (_, by, than) => Expectation::Faster {
                than: than.expect("the grammar has a name after `than`"),
                by,
            },
        }
    }

    fn expected_event(&mut self, pair: Pair<'_, Rule>, base: usize) -> ExpectedEvent {
        let parts: Vec<_> = pair.into_inner().collect();
        let is_capture = parts.iter().any(|part| part.as_rule() == Rule::kw_captured);
        let mut places = (parts.into_iter()).filter(|part| part.as_rule() == Rule::place);
        match (places.next(), places.next()) {
            (Some(block), Some(by)) if is_capture => ExpectedEvent::Captured {
                block: self.block(block, base),
                by: self.block(by, base),
            },
            (Some(phase), _) => ExpectedEvent::Phase(self.new_place(phase, base)),
            _ => ExpectedEvent::Complete,
        }
    }

    fn let_(&mut self, pair: Pair<'_, Rule>, base: usize) -> Let {
        let value = self.exprs(pair.clone(), base);
        Let {
            name: self.first_name(pair, base),
            value: two(value).0,
        }
    }

    fn exprs(&mut self, pair: Pair<'_, Rule>, base: usize) -> Vec<Expr> {
        pair.into_inner()
            .filter(|pair| pair.as_rule() == Rule::expr)
            .map(|pair| self.expr(pair, base))
            .collect()
    }

    fn for_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> For {
        let range = pair
            .clone()
            .into_inner()
            .find(|part| part.as_rule() == Rule::range);
        let range = range.map_or_else(|| two(Vec::new()), |range| self.range(range, base));
        For {
            counter: self.first_name(pair, base),
            range,
            body: Vec::new(),
        }
    }

    fn if_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> If {
        let mut parts = pair.into_inner().peekable();
        let is_else = parts
            .next_if(|part| part.as_rule() == Rule::kw_else)
            .is_some();
        let condition = parts.find(|part| part.as_rule() == Rule::condition);
        If {
            is_else,
            condition: condition.map(|condition| self.condition(condition, base)),
            body: Vec::new(),
        }
    }

    fn phase_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> PhaseDeclaration {
        let span = span_of(&pair, base);
        let mut phase = PhaseDeclaration {
            name: Place {
                path: SmallVec::new(),
                face: None,
                span,
            },
            timeout: None,
            body: Vec::new(),
            handler: None,
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::place => phase.name = self.new_place(part, base),
                Rule::quantity => phase.timeout = Some(self.quantity(part, base)),
                _ => {}
            }
        }
        phase
    }

    /// Builds the time of a `wait`.
    fn wait(&mut self, pair: Pair<'_, Rule>, base: usize) -> Quantity {
        let span = span_of(&pair, base);
        let quantity = (pair.into_inner()).find(|part| part.as_rule() == Rule::time);
        quantity.map_or(
            Quantity {
                value: 0.0,
                unit: Vec::new(),
                span,
            },
            |quantity| self.quantity(quantity, base),
        )
    }

    fn seed_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> Seed {
        Seed {
            size: two(self.exprs(pair, base)),
            body: Vec::new(),
        }
    }

    fn pattern_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> Pattern {
        let names = self.names(pair.clone(), base);
        let parameters = pair.clone().into_inner();
        let parameters = parameters.filter(|part| part.as_rule() == Rule::pattern_parameter);
        let parameters: Vec<Parameter> = (parameters)
            .map(|part| Parameter {
                default: self.exprs(part.clone(), base).pop(),
                name: self.first_name(part, base),
            })
            .collect();
        Pattern {
            name: self.first_name_of(&names, &pair, base),
            parameters,
            body: Vec::new(),
        }
    }

    fn assembly_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> Assembly {
        let names = self.names(pair.clone(), base);
        let inner = pair.clone().into_inner();
        let parameters = inner.filter(|part| part.as_rule() == Rule::parameters);
        let parameters = parameters.flat_map(Pair::into_inner);
        let parameters = parameters.filter(|part| part.as_rule() == Rule::parameter);
        Assembly {
            name: self.first_name_of(&names, &pair, base),
            parameters: parameters.map(|part| self.let_(part, base)).collect(),
            scene: names.get(1).copied(),
            body: Vec::new(),
        }
    }

    fn aggregate(&mut self, pair: Pair<'_, Rule>, base: usize) -> Aggregate {
        let names = self.names(pair.clone(), base);
        let timeout = (pair.clone().into_inner()).find(|part| part.as_rule() == Rule::quantity);
        Aggregate {
            name: self.first_name_of(&names, &pair, base),
            scene: names.get(1).copied(),
            timeout: timeout.map(|quantity| self.quantity(quantity, base)),
            size: two(self.exprs(pair, base)).0,
        }
    }

    fn scene_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> SceneDeclaration {
        let names = self.names(pair.clone(), base);
        SceneDeclaration {
            name: self.first_name_of(&names, &pair, base),
            base: names.get(1).copied(),
            terms: Vec::new(),
        }
    }

    fn shape_head(&mut self, pair: Pair<'_, Rule>, base: usize) -> Shape {
        let names = self.names(pair.clone(), base);
        let name = self.first_name_of(&names, &pair, base);
        let at = self.exprs(pair, base);
        let at = (at.len() == 2).then(|| two(at));
        Shape {
            name,
            at,
            layers: Vec::new(),
        }
    }

    fn first_name_of(&mut self, names: &[Name], pair: &Pair<'_, Rule>, base: usize) -> Name {
        names.first().copied().unwrap_or_else(|| Name {
            symbol: self.symbols.intern(""),
            span: span_of(pair, base),
        })
    }
}

fn import(pair: Pair<'_, Rule>, base: usize) -> Import {
    let whole = span_of(&pair, base);
    let string = pair
        .into_inner()
        .find(|part| part.as_rule() == Rule::string);
    let (path, path_span) = string.map_or((String::new(), whole), |string| {
        let path = string.as_str().trim_matches('"').to_owned();
        (path, span_of(&string, base))
    });
    Import { path, path_span }
}

/// Returns the time in an `after`. Returns `None` if there is none.
fn delay<'i>(after: &Pair<'i, Rule>) -> Option<Pair<'i, Rule>> {
    let mut parts = after.clone().into_inner();
    let delay = parts.find(|part| part.as_rule() == Rule::delay)?;
    delay.into_inner().next()
}
