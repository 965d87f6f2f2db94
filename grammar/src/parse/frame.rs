//! Open blocks during parsing.
use super::{MAX_DEPTH, Parser, Rule};
use crate::error::SyntaxErrorKind;
use crate::tree::{Item, ItemKind, Layer, Term};
use crate::{Span, Symbol};

/// Grammar mode inside a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Block,
    Scene,
    Shape,
}

impl Mode {
    /// Returns the rule for a sequence of pieces.
    pub const fn run(self) -> Rule {
        match self {
            Mode::Block => Rule::pieces,
            Mode::Scene => Rule::scene_pieces,
            Mode::Shape => Rule::shape_pieces,
        }
    }

    /// Returns the rule for one piece.
    pub const fn single(self) -> Rule {
        match self {
            Mode::Block => Rule::any_piece,
            Mode::Scene => Rule::any_scene_piece,
            Mode::Shape => Rule::any_shape_piece,
        }
    }

    /// Returns the initial size of the window \[bytes\]. Small blocks have small windows, because a
    /// sequence may read beyond its block.
    pub const fn window(self) -> usize {
        match self {
            Mode::Block => 1 << 15,
            Mode::Scene | Mode::Shape => 1 << 8,
        }
    }
}

/// A block whose closing brace has not been read yet.
pub struct OpenBlock {
    pub content: OpenBlockContent,
    /// Position of its opening brace, or of its head.
    pub opened: Span,
    /// Items read so far.
    pub body: Vec<Item>,
    /// Start of the block without its documentation.
    pub start: u32,
}

/// Kind of a block.
pub enum OpenBlockContent {
    /// A block whose items belong to `Item::body_mut`.
    Items(Box<Item>),
    /// A scene with its words so far.
    Scene(Box<Item>, Vec<Term>),
    /// Braces in a scene.
    SceneBlock(Vec<Term>),
    /// A shape with its layers so far.
    Shape(Box<Item>),
    /// A layer of the enclosing shape.
    Layer(Layer),
    /// A block with a wrong head. Its content is read and dropped.
    Broken(Mode),
}

impl OpenBlock {
    pub fn mode(&self) -> Mode {
        match self.content {
            OpenBlockContent::Items(_) => Mode::Block,
            OpenBlockContent::Scene(..) | OpenBlockContent::SceneBlock(_) => Mode::Scene,
            OpenBlockContent::Shape(_) | OpenBlockContent::Layer(_) => Mode::Shape,
            OpenBlockContent::Broken(mode) => mode,
        }
    }

    /// Returns the kind of the block as a noun for messages.
    pub fn noun(&self) -> &'static str {
        match &self.content {
            OpenBlockContent::Items(item)
            | OpenBlockContent::Scene(item, _)
            | OpenBlockContent::Shape(item) => item.noun(),
            OpenBlockContent::SceneBlock(_) => "a scene",
            OpenBlockContent::Layer(_) => "a layer",
            OpenBlockContent::Broken(_) => "a block",
        }
    }
}

impl Parser<'_, '_> {
    /// Opens a block whose head ends at its brace.
    pub fn open(&mut self, content: OpenBlockContent, span: Span) {
        if self.frames.len() == MAX_DEPTH {
            self.error(SyntaxErrorKind::TooDeep, span);
            self.stop();
            return;
        }
        self.frames.push(OpenBlock {
            content,
            opened: Span::new(span.end.saturating_sub(1), span.end),
            body: Vec::new(),
            start: span.start,
        });
    }

    /// Closes the innermost block.
    pub fn close(&mut self, span: Span) {
        if self.goes_on(span.end as usize) {
            let what = self.frames.last().map_or("a block", OpenBlock::noun);
            *self.surplus() -= 1;
            return self.error(SyntaxErrorKind::ClosedEarly { what }, span);
        }
        self.dangling_docs();
        match self.frames.pop() {
            Some(frame) => self.finish(frame, span.end),
            None => {
                *self.surplus() -= 1;
                self.error(SyntaxErrorKind::Unopened, span);
            }
        }
    }

    /// Adds a block, complete or not, to the block around it.
    pub fn finish(&mut self, frame: OpenBlock, end: u32) {
        let OpenBlock {
            content,
            body,
            start,
            ..
        } = frame;
        match content {
            OpenBlockContent::Items(mut item) => {
                if let Some(slot) = item.body_mut() {
                    *slot = body;
                }
                self.close_item(*item, end);
            }
            OpenBlockContent::Scene(mut item, terms) => {
                if let ItemKind::Scene(scene) = &mut item.kind {
                    scene.terms = terms;
                }
                self.close_item(*item, end);
            }
            OpenBlockContent::SceneBlock(terms) => {
                let block = Term::Block(terms, Span::new(start, end));
                self.push_term(block);
            }
            OpenBlockContent::Shape(item) => self.close_item(*item, end),
            OpenBlockContent::Layer(mut layer) => {
                layer.span.end = end;
                if let Some(OpenBlockContent::Shape(item)) =
                    self.frames.last_mut().map(|f| &mut f.content)
                    && let ItemKind::Shape(shape) = &mut item.kind
                {
                    shape.layers.push(layer);
                }
            }
            // A broken block around it makes these words doubtful as well.
            OpenBlockContent::Broken(_) => {
                let outer = self.frames.last().map(|frame| &frame.content);
                if !matches!(outer, Some(OpenBlockContent::Broken(_))) {
                    self.doubt(start as usize, end as usize);
                }
            }
        }
    }

    fn close_item(&mut self, mut item: Item, end: u32) {
        item.span.end = end;
        self.keep(item);
    }

    /// Adds an item to the block.
    pub fn keep(&mut self, item: Item) {
        match self.frames.last_mut() {
            None => self.root.push(item),
            Some(OpenBlock {
                content: OpenBlockContent::Items(_),
                body,
                ..
            }) => body.push(item),
            // The content of a broken block is dropped.
            Some(_) => {}
        }
    }

    /// Adds a word or value to the open scene.
    pub fn push_term(&mut self, term: Term) {
        let content = self.frames.last_mut().map(|frame| &mut frame.content);
        if let Some(OpenBlockContent::Scene(_, terms) | OpenBlockContent::SceneBlock(terms)) =
            content
        {
            terms.push(term);
        }
    }

    /// Records the words of a skipped part.
    pub fn doubt(&mut self, start: usize, end: usize) {
        let part = &self.text[start..end.max(start)];
        for word in part.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            if !word.is_empty() {
                let symbol: Symbol = self.symbols.intern(word);
                self.doubtful.insert(symbol);
            }
        }
    }
}
