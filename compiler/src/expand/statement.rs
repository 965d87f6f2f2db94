//! Expands captures, releases, loops and instances.
use stochc_grammar::tree::{Arrow, Chain, EventReference, For, Instance, Place, Release};
use stochc_grammar::{Span, Symbol};
use stochc_ir::Face;
use stochc_ir::table::RoleId;

use super::expander::{Expander, Pass};
use super::scope::BoundValue;
use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic, Fix, suggestion};
use crate::expanded::{AfterConstraint, EventId, EventKind, ExpandedEvent, NameKey, ReleaseDelay};

impl<'a> Expander<'a, '_> {
    /// Expands the captures of a chain in order.
    pub fn chain(&mut self, chain: &'a Chain) {
        let first = self.grown.events;
        let head = self.single(
            &chain.head,
            "let each block capture in a loop: `for i in 1..3 { T[i].up -> ... }`",
            None,
        );
        let mut parent = head.map(|(key, _)| self.role(key));
        let mut face = head.and_then(|(_, face)| face);
        let mut parent_place = &chain.head;
        for link in &chain.links {
            if self.exhausted || !self.step(link.place.span) {
                return;
            }
            let location = self.location(parent_place.span.to(link.place.span));
            match link.arrow {
                Arrow::One => {
                    let fix = self.other_arrow(parent_place, &link.place, ["->", "->>"]);
                    let help = match parent_place.face {
                        Some(_) => self.row_help(parent_place, &link.place),
                        None => "capture a row of blocks with `->>`".to_owned(),
                    };
                    let child = self.single(&link.place, &help, fix);
                    let used = self.face(parent, face, parent_place);
                    let role = child.map(|(key, _)| self.role(key));
                    match (parent, used, role) {
                        (Some(parent), Some(face), Some(child)) => {
                            self.capture(parent, face, child, location);
                        }
                        _ => self.mark_uncertain(&link.place),
                    }
                    parent = role;
                    face = child.and_then(|(_, face)| face);
                }
                Arrow::Row => {
                    let Some(blocks) = self.place(&link.place) else {
                        self.mark_uncertain(&link.place);
                        parent = None;
                        face = None;
                        continue;
                    };
                    if !blocks.ranged {
                        let mut diagnostic =
                            Diagnostic::new(Code::RangeMisused, "`->>` needs a range of blocks")
                                .label(self.location(link.place.span), "this is one block")
                                .help("write `->` for one block, or a range such as `T[1..12]`");
                        diagnostic.fix = self.other_arrow(parent_place, &link.place, ["->>", "->"]);
                        self.diagnostics.push(diagnostic);
                    }
                    let used = self.face(parent, face, parent_place);
                    if parent.is_none() || used.is_none() {
                        self.mark_uncertain(&link.place);
                    }
                    for key in blocks.keys.iter() {
                        let child = self.role(key);
                        if let (Some(parent), Some(face)) = (parent, used) {
                            self.capture(parent, face, child, location);
                        }
                        parent = Some(child);
                        if self.exhausted || !self.step(link.place.span) {
                            return;
                        }
                    }
                    face = blocks.face;
                }
            }
            parent_place = &link.place;
        }
        if let (Some(_), Some(last)) = (face, chain.links.last()) {
            let span = last.place.face.map_or(last.place.span, |(_, span)| span);
            let mut diagnostic = Diagnostic::new(
                Code::FaceMisused,
                "the last face of the chain captures nothing",
            )
            .label(self.location(span), "no `->` follows this face")
            .help("remove the face, or add a capture: `-> X`");
            if last.place.face.is_some() {
                let dotted = self.location(Span::new(span.start - 1, span.end));
                // A capture may be missing after this place.
                diagnostic.fix = Some(Fix::remove(dotted, "remove the face").unsafe_if(true));
            }
            self.diagnostics.push(diagnostic);
        }
        if first < self.grown.events {
            self.after(EventId(first as u32), &chain.after);
        }
    }

    /// Returns a fix that replaces one arrow by the other. Returns `None` if other text stands
    /// between the two names.
    fn other_arrow(&self, parent: &Place, child: &Place, [old, new]: [&str; 2]) -> Option<Fix> {
        let between = self.location(Span::new(parent.span.end, child.span.start));
        let text = self.sources.text(between);
        let start = between.span.start + text.find(old)? as u32;
        let arrow = self.location(Span::new(start, start + old.len() as u32));
        (text.trim() == old).then(|| Fix::replace(arrow, new, format!("write `{new}`")))
    }

    /// Returns the advice to write a capture of a range as a row.
    fn row_help(&self, parent: &Place, child: &Place) -> String {
        /// Length of the longest name that the advice repeats \[bytes\].
        const LONGEST: usize = 40;
        let text = |place: &Place| self.sources.text(self.location(place.span));
        let (parent, child) = (text(parent), text(child));
        if parent.len().max(child.len()) > LONGEST || child.contains('\n') {
            return "capture a row of blocks with `->>`".to_owned();
        }
        format!("capture a row of blocks with `->>`: `{parent} ->> {child}`")
    }

    /// Returns the face that the parent captures with. Reports an error if the source names a block
    /// without a face.
    fn face(&mut self, parent: Option<RoleId>, face: Option<Face>, place: &Place) -> Option<Face> {
        if parent.is_some() && face.is_none() {
            let text = place.path.last().map(|segment| segment.name.symbol);
            let name = text.map_or("", |symbol| self.symbols.word(symbol));
            self.diagnostics.push(
                Diagnostic::new(Code::MissingFace, format!("missing face on `{name}`"))
                    .label(
                        self.location(place.span),
                        "a block captures through one of its faces",
                    )
                    .help(format!(
                        "write `{name}.up`, or another of up, down, north, south, east, west"
                    ))
                    .fix(
                        Fix::replace(
                            self.location(Span::new(place.span.end, place.span.end)),
                            ".up",
                            "add `.up`",
                        )
                        .unsafe_if(true),
                    ),
            );
        }
        face
    }

    fn capture(&mut self, parent: RoleId, face: Face, role: RoleId, location: SourceLocation) {
        let face = self.frame.face(face);
        self.push_event(ExpandedEvent {
            kind: EventKind::Capture { parent, face },
            role,
            location,
            valid: true,
        });
    }

    fn after(&mut self, event: EventId, subjects: &'a [EventReference]) {
        // Orders among pre-attached blocks have been reported.
        let subjects = if self.seeding.is_some() {
            &[]
        } else {
            subjects
        };
        for subject in subjects {
            let location = self.location(subject.place.span);
            let Some(blocks) = self.place(&subject.place) else {
                continue;
            };
            for key in blocks.keys.iter() {
                let role = self.role(key);
                self.push_after(AfterConstraint {
                    event,
                    role,
                    release: subject.release,
                    location,
                });
                if self.exhausted || !self.step(subject.place.span) {
                    return;
                }
            }
        }
    }

    pub fn release(&mut self, release: &'a Release) {
        let delay = release.delay.as_deref();
        let time = self.time(delay, "delay");
        for place in &release.places {
            let location = self.location(place.span);
            let Some(blocks) = self.place(place) else {
                self.mark_uncertain(place);
                continue;
            };
            for key in blocks.keys.iter() {
                let role = self.role(key);
                let event = self.push_event(ExpandedEvent {
                    kind: EventKind::Release,
                    role,
                    location,
                    valid: true,
                });
                self.after(event, &release.after);
                if let (Some(time), Some(delay), Pass::Writing) = (time, delay, self.pass) {
                    let location = self.location(delay.span);
                    self.plan.delays.push(ReleaseDelay {
                        event,
                        time,
                        location,
                    });
                }
                if self.exhausted || !self.step(place.span) {
                    return;
                }
            }
        }
    }

    pub fn repeat(&mut self, block: &'a For) {
        let first = self.evaluate(&block.range.0);
        let last = self.evaluate(&block.range.1);
        let location = self.location(block.counter.span);
        let (Some(first), Some(last)) = (first, last) else {
            return self.mark_all_uncertain(&block.body);
        };
        for value in first..=last {
            if self.exhausted || !self.step(block.counter.span) {
                return;
            }
            let mark = self.scope.mark();
            let counter = self.named(block.counter);
            self.scope
                .define(counter, BoundValue::Number(value), location);
            self.items(&block.body);
            self.scope.restore(mark);
        }
    }

    pub fn instance(&mut self, instance: &'a Instance, span: Span) {
        let location = self.location(instance.pattern.span);
        let name = instance.pattern.symbol;
        let definition = self.names.definition(self.file, instance.pattern.span);
        let patterns = &self.declared.patterns;
        let Some(&(file, pattern)) = definition.and_then(|it| patterns.get(&it)) else {
            let word = self.symbols.word(name);
            let known = patterns.values();
            let known = known.map(|(_, known)| self.symbols.word(known.name.symbol));
            let diagnostic =
                Diagnostic::about(Code::UnknownName, "cannot find pattern `{}`", &[word])
                    .label(location, "no pattern has this name")
                    .suggest(
                        location,
                        suggestion(self.diagnostics, word, known),
                        || match word {
                            "allow" | "deny" => format!(
                                "write it without parentheses: `{word} unused-seed \"reason\"`"
                            ),
                            _ => format!("declare it: `pattern {word}(base) {{ ... }}`"),
                        },
                    );
            self.diagnostics.push(diagnostic);
            instance
                .alias
                .iter()
                .for_each(|alias| self.mark_uncertain(alias));
            return;
        };
        if let Some(depth) = self.instances.iter().position(|&(outer, _)| outer == name) {
            self.recursion(depth, location);
            return;
        }
        let values = match self.assign_arguments(instance, (file, pattern), span) {
            Some(assigned) => self.arguments(instance, (file, pattern), &assigned),
            None => vec![Some(BoundValue::Unknown); pattern.parameters.len()],
        };
        let frame = self.frame_of(instance);
        let key = match &instance.alias {
            Some(alias) => self.single_key(alias),
            None => Some(self.anonymous_key(name)),
        };
        let Some(key) = key else {
            instance
                .alias
                .iter()
                .for_each(|alias| self.mark_uncertain(alias));
            return;
        };
        let inside = self.instance_of(key);
        if self.pass == Pass::Writing {
            let is_uncertain = values.contains(&Some(BoundValue::Unknown)) || frame.is_none();
            self.note_instance(inside, instance, span, (file, pattern), is_uncertain);
        }
        let mark = self.scope.enter_instance(inside);
        let outer_file = std::mem::replace(&mut self.file, file);
        let inner = frame.unwrap_or_default().within(self.frame);
        let outer_frame = std::mem::replace(&mut self.frame, inner);
        // A pattern can use the numbers of the assembly.
        let outer_blocks = self.blocks.split_off(1.min(self.blocks.len()));
        self.instances.push((name, location));
        for (parameter, value) in pattern.parameters.iter().zip(values) {
            let default = parameter.default.as_ref();
            let value = value
                .or_else(|| Some(self.evaluate_any(default?)))
                .unwrap_or(BoundValue::Unknown);
            self.define(parameter.name, value);
        }
        self.items(&pattern.body);
        self.instances.pop();
        self.blocks.truncate(1);
        self.blocks.extend(outer_blocks);
        self.file = outer_file;
        self.frame = outer_frame;
        self.scope.restore(mark);
    }

    /// Returns a generated name for an instance that the program does not name.
    fn anonymous_key(&mut self, pattern: Symbol) -> NameKey {
        self.anonymous += 1;
        let word = match self.pass {
            Pass::Writing => {
                let text = format!("{}#{}", self.symbols.word(pattern), self.anonymous);
                self.symbols.intern(&text)
            }
            Pass::Counting => pattern,
        };
        NameKey {
            scope: self.scope.instance,
            word,
            arity: 0,
            index: [0; NameKey::MAX_INDICES],
        }
    }

    fn recursion(&mut self, depth: usize, location: SourceLocation) {
        let first = self.instances[depth..].first();
        let word = first.map_or("", |&(name, _)| self.symbols.word(name));
        let title = format!("pattern `{word}` contains itself");
        let mut diagnostic = Diagnostic::new(Code::RecursivePattern, title)
            .label(location, format!("an instance inside of `{word}`"));
        for &(name, location) in &self.instances[depth..] {
            diagnostic = diagnostic.label(
                location,
                format!("an instance of `{}`", self.symbols.word(name)),
            );
        }
        let help = "repeat with `for` or `->>` instead";
        self.diagnostics.push(diagnostic.help(help));
        self.exhausted = true;
    }
}
