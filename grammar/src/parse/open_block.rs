//! Open blocks, and the rules for their inside.
use super::grammar::Rule;
use crate::Span;
use crate::tree::{Item, Layer, Term};

/// Grammar mode inside a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Block,
    Scene,
    Shape,
}

impl Mode {
    /// Returns the rule for a sequence of pieces in this mode.
    pub const fn run(self) -> Rule {
        match self {
            Mode::Block => Rule::pieces,
            Mode::Scene => Rule::scene_pieces,
            Mode::Shape => Rule::shape_pieces,
        }
    }

    /// Returns the rule for one piece in this mode.
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
    /// Position of the block's first byte, after its documentation.
    pub start: u32,
}

pub enum OpenBlockContent {
    /// A block that contains items, such as an assembly or a loop.
    Items(Box<Item>),
    /// A scene with the terms read so far.
    Scene(Box<Item>, Vec<Term>),
    /// Braces in a scene, with the terms read so far.
    SceneBlock(Vec<Term>),
    /// A shape with the layers read so far.
    Shape(Box<Item>),
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
