//! Reports missing and extra braces instead of the errors that follow from them.
use pest::Parser as _;
use pest::iterators::Pair;

use super::open_block::{Mode, OpenBlock, OpenBlockContent};
use super::parser::Parser;
use super::window::{Cause, Unreadable, cut};
use super::{Rule, SaParser, trivia, words};
use crate::Span;
use crate::error::SyntaxErrorKind;
use crate::scan::code;
use crate::tree::ItemKind;

/// Largest number of bytes that are searched for the next piece.
const AHEAD: usize = 1 << 12;

impl Parser<'_, '_> {
    /// Opens the block whose head begins at `start`, if the only error is a missing brace before
    /// `at`.
    pub fn open_unbraced(&mut self, start: usize, at: usize, error: &Unreadable) -> bool {
        if error.cause != Cause::Word || !error.expected.contains(&Rule::open) {
            return false;
        }
        let rule = self.mode().single();
        // Space and comments before `at` are not part of the head.
        let whole = format!("{}\n{{", &self.text[start..at]);
        let head = SaParser::parse(rule, &whole)
            .ok()
            .and_then(|mut it| it.next());
        let Some(head) = head.filter(|head| is_head(head.as_rule())) else {
            return false;
        };
        // A repetition may end with space, but the last token does not.
        let is_token = |it: &Pair<'_, Rule>| {
            it.as_rule() != Rule::open && it.clone().into_inner().next().is_none()
        };
        let tokens = head.clone().into_inner().flatten().filter(is_token);
        let Some(end) = tokens.last().map(|last| start + last.as_span().end()) else {
            return false;
        };
        if !self.follows(head.as_rule(), end, at) {
            return false;
        }
        *self.surplus() -= 1;
        let braced = format!("{}{{", &self.text[start..end]);
        if let Some(head) = SaParser::parse(rule, &braced)
            .ok()
            .and_then(|mut it| it.next())
        {
            self.build(head, start);
        }
        let what = self.frames.last().map_or("a block", OpenBlock::noun);
        let here = Span::new(end as u32, end as u32);
        self.error(SyntaxErrorKind::MissingBrace { what }, here);
        self.at = end;
        true
    }

    /// Returns whether the source at `at` belongs to the block whose head ends at `end`.
    fn follows(&self, head: Rule, end: usize, at: usize) -> bool {
        let mode = match head {
            Rule::scene_head => Mode::Scene,
            Rule::shape_head | Rule::layer_head => Mode::Shape,
            _ => Mode::Block,
        };
        // Every word can stand in a scene, so a word of the same line may belong to the head.
        if mode == Mode::Scene && !self.text[end..at].contains('\n') {
            return false;
        }
        let head = match head {
            Rule::for_head | Rule::if_head => self.holder(self.frames.len()),
            head => Some(head),
        };
        self.next_piece(at, mode)
            .is_some_and(|next| holds(head, next))
    }

    /// Returns whether a `}` that ends at `end` is an extra brace. The brace is extra if the next
    /// piece fits into the innermost block, but not into the block around that block.
    pub fn continues(&mut self, end: usize) -> bool {
        let Some(outer) = self.frames.len().checked_sub(1) else {
            return false;
        };
        if *self.surplus() <= 0 {
            return false;
        }
        let at = trivia::skip(self.text, end);
        let holds_next = |depth: usize| {
            let mode = (self.frames[..depth].last()).map_or(Mode::Block, OpenBlock::mode);
            let next = self.next_piece(at, mode);
            next.is_some_and(|next| next == Rule::close || holds(self.holder(depth), next))
        };
        !holds_next(outer) && holds_next(outer + 1)
    }

    /// Returns the number of closing braces in the file that have no opening brace. Reported ones
    /// are not counted.
    pub fn surplus(&mut self) -> &mut i64 {
        self.surplus.get_or_insert_with(|| surplus(self.text))
    }

    /// Returns the rule of the piece at a byte, after any comments. Returns `None` if there is no
    /// piece.
    fn next_piece(&self, at: usize, mode: Mode) -> Option<Rule> {
        let mut at = trivia::skip(self.text, at);
        while self.text[at..].starts_with("///") {
            let end = trivia::end_of_line(self.text.as_bytes(), at);
            at = trivia::skip(self.text, end);
        }
        // In a scene, every word is a piece, even one that begins a declaration.
        let word = words::found(self.text, at);
        let declares = |begins: &&str| begins.trim_matches('`') == word;
        if mode == Mode::Scene && words::beginnings(None).iter().any(declares) {
            return None;
        }
        let window = &self.text[at..cut(self.text, at.saturating_add(AHEAD))];
        let mut pairs = SaParser::parse(mode.single(), window).ok()?;
        pairs.next().map(|piece| piece.as_rule())
    }

    /// Returns the rule of the head of the innermost block that is neither a loop nor a condition, among the first
    /// `depth` blocks. Returns `None` if there is no such block.
    fn holder(&self, depth: usize) -> Option<Rule> {
        (self.frames[..depth].iter().rev())
            .map(head)
            .find(|&head| !matches!(head, Rule::for_head | Rule::if_head))
    }
}

fn head(frame: &OpenBlock) -> Rule {
    match &frame.content {
        OpenBlockContent::Items(item) => match item.kind {
            ItemKind::Assembly(_) => Rule::assembly_head,
            ItemKind::Seed(_) => Rule::seed_head,
            ItemKind::Phase(_) => Rule::phase_head,
            ItemKind::Handler(_) => Rule::handler_head,
            ItemKind::For(_) => Rule::for_head,
            ItemKind::If(_) => Rule::if_head,
            _ => Rule::pattern_head,
        },
        OpenBlockContent::Scene(..) | OpenBlockContent::SceneBlock(_) => Rule::scene_head,
        OpenBlockContent::Shape(_) => Rule::shape_head,
        OpenBlockContent::Layer(_) => Rule::layer_head,
        // A broken block can contain anything.
        OpenBlockContent::Broken(_) => Rule::program,
    }
}

fn is_head(rule: Rule) -> bool {
    use Rule as R;
    matches!(
        rule,
        R::assembly_head
            | R::seed_head
            | R::phase_head
            | R::handler_head
            | R::for_head
            | R::if_head
            | R::pattern_head
    ) || matches!(rule, R::scene_head | R::shape_head | R::layer_head)
}

/// Returns whether a piece is valid in a block with this head, or at the top level.
fn holds(head: Option<Rule>, next: Rule) -> bool {
    use Rule as R;
    matches!(
        (head, next),
        (Some(R::program), _)
            | (_, R::level | R::let_)
            | (
                None,
                R::assembly_head | R::aggregate | R::scene_head | R::import
            )
            | (
                None | Some(R::assembly_head),
                R::pattern_head | R::shape_head
            )
            | (
                Some(R::assembly_head),
                R::seed_head
                    | R::phase_head
                    | R::handler_head
                    | R::expect
                    | R::instance
                    | R::for_head
                    | R::if_head
            )
            | (
                Some(R::seed_head),
                R::seat | R::chain | R::instance | R::for_head | R::if_head
            )
            | (Some(R::phase_head), R::yields)
            | (Some(R::handler_head), R::release | R::wait | R::retry)
            | (Some(R::pattern_head), R::seat | R::phase_head)
            | (
                Some(R::phase_head | R::pattern_head),
                R::chain | R::release | R::wait | R::instance | R::for_head | R::if_head,
            )
            | (
                Some(R::scene_head),
                R::word | R::quantity | R::span_of_values | R::open
            )
            | (Some(R::shape_head), R::layer_head)
            | (Some(R::layer_head), R::row)
    )
}

/// Returns the number of closing braces in a text that have no opening brace.
fn surplus(text: &str) -> i64 {
    let bytes = code(text).flat_map(|(_, code)| code.bytes());
    let signs = bytes.map(|byte| match byte {
        b'}' => 1,
        b'{' => -1,
        _ => 0,
    });
    signs.sum()
}
