//! Open blocks during parsing.
use super::MAX_DEPTH;
use super::open_block::{OpenBlock, OpenBlockContent};
use super::parser::Parser;
use crate::error::SyntaxErrorKind;
use crate::tree::{Item, ItemKind, Term, TimeoutHandler};
use crate::{Span, Symbol};

impl Parser<'_, '_> {
    /// Opens a block. `span` ends with its opening brace.
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

    pub fn close(&mut self, span: Span) {
        if self.continues(span.end as usize) {
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
            // This block is in a broken block, so its words are doubtful as well.
            OpenBlockContent::Broken(_) => {
                let outer = self.frames.last().map(|frame| &frame.content);
                if !matches!(outer, Some(OpenBlockContent::Broken(_))) {
                    self.mark_uncertain(start as usize, end as usize);
                }
            }
        }
    }

    fn close_item(&mut self, mut item: Item, end: u32) {
        item.span.end = end;
        if let ItemKind::Handler(handler) = item.kind {
            return self.attach(*handler, end);
        }
        self.keep(item);
    }

    /// Adds a handler to the phase before it. A misplaced handler has been reported.
    fn attach(&mut self, mut handler: TimeoutHandler, end: u32) {
        let items = match self.frames.last_mut() {
            None => &mut self.root,
            Some(frame) => &mut frame.body,
        };
        handler.span.end = end;
        if let Some(Item { kind, span, .. }) = items.last_mut()
            && let ItemKind::Phase(phase) = kind
            && phase.handler.is_none()
        {
            span.end = end;
            phase.handler = Some(Box::new(handler));
        }
    }

    /// Adds an item to the innermost open block, or to the top level.
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

    /// Marks the words between two bytes as uncertain, because this part of the source was skipped.
    pub fn mark_uncertain(&mut self, start: usize, end: usize) {
        let part = &self.text[start..end.max(start)];
        for word in part.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            if !word.is_empty() {
                let symbol: Symbol = self.symbols.intern(word);
                self.uncertain.insert(symbol);
            }
        }
    }
}
