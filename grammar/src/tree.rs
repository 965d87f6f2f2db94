//! The syntax tree: what a file says, with the place of every word.
use smallvec::SmallVec;
use stochc_ir::Face;

use crate::{Span, Symbol};

/// A whole file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    /// Its declarations, in source order.
    pub items: Vec<Item>,
}

/// A declaration or statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Lines of `///` before it, without the slashes.
    pub docs: Docs,
    /// From its first word to its last.
    pub span: Span,
    /// What it is.
    pub kind: ItemKind,
}

/// Lines of documentation; most items have none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Docs(pub Option<Box<Vec<String>>>);

/// What an item is.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `A.up -> E.up -> I`
    Chain(Chain),
    /// `release D, E`
    Release(Release),
    /// `tower(A, 2) as a`
    Instance(Box<Instance>),
    /// `A at (0, 0)`
    Seat(Box<Seat>),
    /// `for i in 1..4 { ... }`
    For(Box<For>),
    /// `let n = 6`
    Let(Box<Let>),
    /// `yields tower`
    Yields(Name),
    /// `allow unused-seed "kept for the next phase"`
    Level(Box<LintDirective>),
    /// `phase corners { ... }`
    Phase(Box<PhaseDeclaration>),
    /// `seed plate 3 x 3 { ... }`
    Seed(Box<Seed>),
    /// `pattern tower(base, height) { ... }`
    Pattern(Box<Pattern>),
    /// `assembly five_tower { ... }`
    Assembly(Box<Assembly>),
    /// `aggregate four in tank to 4`
    Aggregate(Box<Aggregate>),
    /// `shape bridge { ... }`
    Shape(Box<Shape>),
    /// `scene tank { ... }`
    Scene(Box<SceneDeclaration>),
    /// `import "towers.sa"`
    Import(Box<Import>),
}

/// A word with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name {
    /// The word.
    pub symbol: Symbol,
    /// Where it stands.
    pub span: Span,
}

/// Captures, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The first parent, with the face it magnetizes.
    pub head: Place,
    /// What is captured, one after the other; never empty.
    pub links: Vec<Link>,
    /// What has to have happened before the first capture.
    pub after: Vec<EventReference>,
}

/// One arrow of a chain and what it captures.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Which arrow.
    pub arrow: Arrow,
    /// What is captured, with the face that captures the next.
    pub place: Place,
}

/// The two arrows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrow {
    /// `->`: one block.
    One,
    /// `->>`: all the blocks of a range, in a row, all through the same face.
    Row,
}

/// An event to wait for.
#[derive(Clone, Debug, PartialEq)]
pub struct EventReference {
    /// Whether the release is meant, not the capture.
    pub release: bool,
    /// Of what.
    pub place: Place,
}

/// Lets blocks go.
#[derive(Clone, Debug, PartialEq)]
pub struct Release {
    /// Which.
    pub places: Vec<Place>,
    /// What has to have happened before.
    pub after: Vec<EventReference>,
}

/// A block or several, and a face of it if one is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// From the outermost pattern instance to the name itself.
    pub path: SmallVec<[Segment; 1]>,
    /// The face written last, with its place.
    pub face: Option<(Face, Span)>,
    /// The whole of it.
    pub span: Span,
}

/// One name of a path, with its indices.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The name.
    pub name: Name,
    /// Its indices, if it has any.
    pub index: Option<Box<[Subscript]>>,
}

/// One index: a number or a range of them.
#[derive(Clone, Debug, PartialEq)]
pub enum Subscript {
    /// `[2]`
    One(Expr),
    /// `[1..12]`, both ends included.
    Range(Expr, Expr),
}

/// Grows a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Which.
    pub pattern: Name,
    /// What its parameters stand for.
    pub arguments: Vec<Argument>,
    /// The name under which its own names are known outside.
    pub alias: Option<Place>,
}

/// What a parameter stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum Argument {
    /// A number, or a bare name whatever it stands for.
    Expr(Expr),
    /// A block.
    Place(Place),
}

/// Puts a seed on the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Seat {
    /// Its name.
    pub place: Place,
    /// Blocks east and north of the plate's south-west block.
    pub at: (Expr, Expr),
}

/// Repeats statements.
#[derive(Clone, Debug, PartialEq)]
pub struct For {
    /// The name of the counter.
    pub counter: Name,
    /// From the first to the last, both included.
    pub range: (Expr, Expr),
    /// What is repeated.
    pub body: Vec<Item>,
}

/// Names a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// The name.
    pub name: Name,
    /// The number.
    pub value: Expr,
}

/// Sets the level of a finding in the block around it.
#[derive(Clone, Debug, PartialEq)]
pub struct LintDirective {
    /// What becomes of it.
    pub verdict: LintDirectiveKind,
    /// The kind of the finding, with its hyphens.
    pub code: Name,
    /// Why, as written between the quotation marks; empty where it is missing, which is an error.
    pub reason: String,
}

/// What becomes of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LintDirectiveKind {
    /// It is not told.
    Allow,
    /// It is an error.
    Deny,
}

/// A stage of the construction.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseDeclaration {
    /// Its name; indexed inside a loop.
    pub name: Place,
    /// The time after which it has failed.
    pub timeout: Option<Quantity>,
    /// Its statements.
    pub body: Vec<Item>,
}

/// The plate from which everything grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Seed {
    /// Blocks from west to east, and from south to north.
    pub size: (Expr, Expr),
    /// The seats, and captures of blocks that are attached by hand.
    pub body: Vec<Item>,
}

/// Statements to be grown several times.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Its name.
    pub name: Name,
    /// Its parameters.
    pub parameters: Vec<Name>,
    /// Its statements.
    pub body: Vec<Item>,
}

/// A program.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// Its name.
    pub name: Name,
    /// The scene it runs in.
    pub scene: Option<Name>,
    /// Its plate, phases and declarations.
    pub body: Vec<Item>,
}

/// Free blocks that bond to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Aggregate {
    /// Its name.
    pub name: Name,
    /// The scene it runs in.
    pub scene: Option<Name>,
    /// The blocks of a group with which it is complete.
    pub size: Expr,
    /// The time after which the next size has failed.
    pub timeout: Option<Quantity>,
}

/// A target, as layers of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Its name.
    pub name: Name,
    /// The south-west corner of every layer; (0, 0) if left out.
    pub at: Option<(Expr, Expr)>,
    /// Its layers.
    pub layers: Vec<Layer>,
}

/// One layer of a shape, or several equal ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Heights above the plate.
    pub heights: Subscript,
    /// From the `layer` to its closing brace.
    pub span: Span,
    /// The north row first.
    pub rows: Vec<LayerRow>,
}

/// One row of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerRow {
    /// From west to east: is there a block?
    pub cells: Vec<bool>,
    /// Where it stands.
    pub span: Span,
}

/// A physical world, as written; what its words mean is the compiler's to say.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDeclaration {
    /// Its name.
    pub name: Name,
    /// The scene whose clauses it takes over.
    pub base: Option<Name>,
    /// The words and values between its braces.
    pub terms: Vec<Term>,
}

/// A word or value of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// `restitution`
    Word(Name),
    /// `20cm`
    Quantity(Quantity),
    /// `0 .. 0.4 m/s`; a first value without a unit has the second one's.
    Range(Quantity, Quantity),
    /// `{ ... }`
    Block(Vec<Term>, Span),
}

/// A value with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The number as written.
    pub value: f64,
    /// Factors of the unit; empty: a pure number.
    pub unit: Vec<UnitFactor>,
    /// Where it stands.
    pub span: Span,
}

/// One factor of a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFactor {
    /// With its prefix, such as `mPa`.
    pub symbol: String,
    /// Negative behind a `/`.
    pub power: i8,
}

/// Reads another file's declarations.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// As written, relative to the importing file.
    pub path: String,
    /// Where it stands.
    pub path_span: Span,
}

/// Integer arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// What an expression is.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `6`
    Int(i64),
    /// `n`
    Name(Symbol),
    /// `-n`
    Negate(Box<Expr>),
    /// `n + 1`
    Binary(Operator, Box<(Expr, Expr)>),
}

/// The operators, with the rules of precedence of arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`, rounded towards zero.
    Divide,
    /// `%`, the remainder of that.
    Remainder,
}

impl Operator {
    /// Its value; `None`: it has no 64 bits, or there is none.
    pub fn of(self, left: i64, right: i64) -> Option<i64> {
        match self {
            Operator::Add => left.checked_add(right),
            Operator::Subtract => left.checked_sub(right),
            Operator::Multiply => left.checked_mul(right),
            Operator::Divide => left.checked_div(right),
            // That of the least number by -1 is 0, though the quotient has no 64 bits.
            Operator::Remainder => (right != 0).then(|| left.wrapping_rem(right)),
        }
    }
}

impl LintDirectiveKind {
    /// Its word in the language.
    pub const fn word(self) -> &'static str {
        match self {
            LintDirectiveKind::Allow => "allow",
            LintDirectiveKind::Deny => "deny",
        }
    }
}

impl Operator {
    /// Its sign.
    pub const fn sign(self) -> &'static str {
        match self {
            Operator::Add => "+",
            Operator::Subtract => "-",
            Operator::Multiply => "*",
            Operator::Divide => "/",
            Operator::Remainder => "%",
        }
    }

    /// Higher binds tighter; all associate to the left.
    pub const fn precedence(self) -> u8 {
        match self {
            Operator::Add | Operator::Subtract => 1,
            Operator::Multiply | Operator::Divide | Operator::Remainder => 2,
        }
    }
}

impl Item {
    /// The statements of a block; `None` for what has none.
    pub(crate) fn body_mut(&mut self) -> Option<&mut Vec<Item>> {
        match &mut self.kind {
            ItemKind::For(block) => Some(&mut block.body),
            ItemKind::Phase(block) => Some(&mut block.body),
            ItemKind::Seed(block) => Some(&mut block.body),
            ItemKind::Pattern(block) => Some(&mut block.body),
            ItemKind::Assembly(block) => Some(&mut block.body),
            _ => None,
        }
    }

    /// The statements of a block; none for what has none.
    pub fn body(&self) -> &[Item] {
        match &self.kind {
            ItemKind::For(block) => &block.body,
            ItemKind::Phase(block) => &block.body,
            ItemKind::Seed(block) => &block.body,
            ItemKind::Pattern(block) => &block.body,
            ItemKind::Assembly(block) => &block.body,
            _ => &[],
        }
    }

    /// What messages call it.
    pub fn noun(&self) -> &'static str {
        match &self.kind {
            ItemKind::Chain(_) => "a capture",
            ItemKind::Release(_) => "a release",
            ItemKind::Instance(_) => "an instance of a pattern",
            ItemKind::Seat(_) => "a seed",
            ItemKind::For(_) => "a loop",
            ItemKind::Let(_) => "a `let`",
            ItemKind::Yields(_) => "a `yields`",
            ItemKind::Level(level) => match level.verdict {
                LintDirectiveKind::Allow => "an `allow`",
                LintDirectiveKind::Deny => "a `deny`",
            },
            ItemKind::Phase(_) => "a phase",
            ItemKind::Seed(_) => "a seed plate",
            ItemKind::Pattern(_) => "a pattern",
            ItemKind::Assembly(_) => "an assembly",
            ItemKind::Aggregate(_) => "an aggregate",
            ItemKind::Shape(_) => "a shape",
            ItemKind::Scene(_) => "a scene",
            ItemKind::Import(_) => "an import",
        }
    }
}
