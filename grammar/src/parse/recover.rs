//! Continues after a broken statement.
use super::open_block::{Mode, OpenBlockContent};
use super::parser::Parser;
use super::window::{self, Cause, Unreadable};
use super::{Rule, trivia, words};
use crate::Span;
use crate::error::SyntaxErrorKind;
use crate::tree::{
    Assembly, Chain, Docs, Item, ItemKind, Name, PhaseDeclaration, Place, Release, Segment,
};

impl Parser<'_, '_> {
    /// Reports an unreadable piece, and skips it up to the end of its line or to a brace.
    pub fn recover(&mut self, error: Unreadable) {
        let start = self.at;
        let error = window::sharpen(self.text, start, error);
        let at = error.at.max(start);
        if self.open_unbraced(start, at, &error) {
            return;
        }
        if self.lone_unit(at) || self.waits_in_vain(start) {
            return;
        }
        if matches!(self.text.as_bytes().get(start), Some(b'[' | b'{')) {
            self.retract(start);
        }
        self.report(&error, start, at);
        self.docs.clear();
        // A statement may follow a separator of another language.
        if at == start && self.text[start..].starts_with(';') {
            self.at = start + 1;
            return;
        }
        // A single word is the whole error. The next line may be right.
        let (end, brace) = self.end_of_piece(
            self.lone_word(start, at)
                .map_or(at, |word| start + word.len()),
        );
        self.mark_uncertain(start, end);
        self.at = end;
        if brace {
            let content = self.broken_head(start, end);
            self.open(content, Span::new(start as u32, end as u32));
        }
    }

    fn report(&mut self, error: &Unreadable, start: usize, at: usize) {
        let found = words::found(self.text, at);
        let span = Span::new(at as u32, (at + found.len()) as u32);
        let kind = match error.cause {
            Cause::Depth => SyntaxErrorKind::TooDeep,
            Cause::Length => SyntaxErrorKind::StatementTooLong,
            Cause::Word => SyntaxErrorKind::Unexpected {
                found: found.to_owned(),
                expected: if at == start {
                    words::beginnings(self.frames.last()).to_vec()
                } else {
                    let last = self.frames.last().and_then(|frame| frame.body.last());
                    let is_release =
                        last.is_some_and(|item| matches!(item.kind, ItemKind::Release(_)));
                    let is_after = error.expected.contains(&Rule::subject);
                    let phrase = |&rule: &Rule| match rule {
                        // Only a release can wait for a time.
                        Rule::number if is_after => is_release.then_some("a time"),
                        _ => words::word(rule),
                    };
                    let mut expected: Vec<_> = error.expected.iter().filter_map(phrase).collect();
                    expected.sort_unstable();
                    expected.dedup();
                    // A name in a list is more often complete than the name of a function.
                    if expected.contains(&"`,`") {
                        expected.retain(|word| *word != "`(`");
                    }
                    // After a keyword, its own alternatives are listed, not those of the block.
                    if self.is_behind_keyword(start, at) && expected.len() > 1 {
                        expected.retain(|word| !matches!(*word, "`(`" | "`->`" | "`at`"));
                    }
                    expected
                },
                after: self.lone_word(start, at).unwrap_or_default().to_owned(),
            },
        };
        self.error(kind, span);
    }

    /// Returns whether only a keyword of the piece precedes a byte.
    fn is_behind_keyword(&self, start: usize, at: usize) -> bool {
        let word = words::found(self.text, start);
        let symbol = self.symbols.get(word);
        symbol.is_some_and(|symbol| self.symbols.is_reserved(symbol))
            && trivia::skip(self.text, start + word.len()) >= at
    }

    /// Returns the first word of a piece if the error directly follows it.
    fn lone_word(&self, start: usize, at: usize) -> Option<&str> {
        let first = words::found(self.text, start);
        let is_alone = at > start && trivia::skip(self.text, start + first.len()) == at;
        is_alone.then_some(first)
    }

    /// Removes the statement that ends directly before a byte, because the error is a part of this
    /// statement.
    fn retract(&mut self, at: usize) {
        let Some(frame) = self.frames.last_mut() else {
            return;
        };
        let continues = |item: &Item| match item.kind {
            // An item with a block is complete.
            ItemKind::Chain(_) | ItemKind::Release(_) => item.span.end as usize == at,
            ItemKind::Instance(_) => trivia::skip(self.text, item.span.end as usize) == at,
            _ => false,
        };
        if let Some(item) = frame.body.pop_if(|item| continues(item)) {
            self.mark_uncertain(item.span.start as usize, at);
        }
    }

    /// Reports an `after` at a statement that cannot wait or already has one. Returns whether it
    /// reported one.
    fn waits_in_vain(&mut self, at: usize) -> bool {
        let after = words::found(self.text, at);
        let Some(last) = self.frames.last().and_then(|frame| frame.body.last()) else {
            return false;
        };
        if after != "after" || trivia::skip(self.text, last.span.end as usize) != at {
            return false;
        }
        let (what, belongs) = match &last.kind {
            ItemKind::Instance(_) | ItemKind::Seat(_) | ItemKind::Yields(_) => {
                ("an `after`", "a capture or a release")
            }
            ItemKind::Chain(Chain { after, .. })
            | ItemKind::Release(Release {
                after, delay: None, ..
            }) if after.is_empty() => return false,
            ItemKind::Chain(_) | ItemKind::Release(_) => {
                ("a second `after`", "the first one: `after A, B`")
            }
            _ => return false,
        };
        let within = last.noun();
        let span = Span::new(at as u32, (at + after.len()) as u32);
        self.error(
            SyntaxErrorKind::Misplaced {
                what,
                within,
                belongs,
                is_read: false,
            },
            span,
        );
        let (end, brace) = self.end_of_piece(at);
        // A brace opens a block here as well.
        self.at = end - usize::from(brace);
        self.mark_uncertain(at, self.at);
        true
    }

    /// Returns the start of the next piece, and whether a brace opens directly before it.
    fn end_of_piece(&self, from: usize) -> (usize, bool) {
        let bytes = self.text.as_bytes();
        let mut at = from;
        while at < bytes.len() {
            match bytes[at] {
                b'\n' => return (at + 1, false),
                b'{' => return (at + 1, true),
                // A brace at the very beginning is part of the error, so that reading always
                // advances.
                b'}' if at > self.at => return (at, false),
                b'/' if trivia::is_comment(&bytes[at..]) => {
                    at = trivia::end_of_line(bytes, at);
                }
                _ => at += 1,
            }
        }
        (at, false)
    }

    /// Returns the kind of block that the first words of an unreadable head suggest.
    fn broken_head(&mut self, start: usize, end: usize) -> OpenBlockContent {
        let head = &self.text[start..end];
        let mut words = head
            .split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
            .filter(|word| !word.is_empty());
        let keyword = words.next().unwrap_or_default();
        let span = Span::new(start as u32, end as u32);
        let name = Name {
            symbol: self.symbols.intern(words.next().unwrap_or("_")),
            span,
        };
        let kind = match keyword {
            "phase" => ItemKind::Phase(Box::new(PhaseDeclaration {
                name: Place {
                    path: [Segment { name, index: None }].into_iter().collect(),
                    face: None,
                    span,
                },
                timeout: None,
                body: Vec::new(),
                handler: None,
            })),
            "assembly" => ItemKind::Assembly(Box::new(Assembly {
                name,
                parameters: Vec::new(),
                scene: None,
                body: Vec::new(),
            })),
            "scene" => return OpenBlockContent::Broken(Mode::Scene),
            "shape" | "layer" => return OpenBlockContent::Broken(Mode::Shape),
            _ => return OpenBlockContent::Broken(self.mode()),
        };
        OpenBlockContent::Items(Box::new(Item {
            docs: Docs(None),
            span,
            kind,
        }))
    }
}
