//! Syntax tree of a file, with the location of every word.
use smallvec::SmallVec;
use stochc_ir::Face;
use stochc_ir::claim::Relation;

use crate::{Span, Symbol};

/// The syntax tree of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    /// Declarations in source order.
    pub items: Vec<Item>,
}

/// A declaration or statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Lines of `///` before the item, without the slashes.
    pub docs: Docs,
    /// Range from the first to the last word of the item.
    pub span: Span,
    /// Content of the item.
    pub kind: ItemKind,
}

/// Lines of documentation. Most items have none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Docs(pub Option<Box<Vec<String>>>);

/// Content of an item.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// Captures: `A.up -> E.up -> I`
    Chain(Chain),
    /// Releases: `release D, E`
    Release(Release),
    /// Instance of a pattern: `tower(A, 2) as a`
    Instance(Box<Instance>),
    /// Position of a seed: `A at (0, 0)`
    Seat(Box<Seat>),
    /// Loop: `for i in 1..4 { ... }`
    For(Box<For>),
    /// Condition: `if n > 2 { ... }`, `else if n == 2 { ... }` or `else { ... }`
    If(Box<If>),
    /// Named number or face: `let n = 6`
    Let(Box<Let>),
    /// Shape that the structure must have: `yields tower`, `yields at least tower`
    Yields(YieldsClaim),
    /// Claim about runs: `expect complete within 8000 ticks with probability >= 0.95`
    Expect(Box<Expectation>),
    /// Level of a warning: `allow unused-seed "kept for the next phase"`
    Level(Box<LintDirective>),
    /// Phase: `phase corners { ... }`
    Phase(Box<PhaseDeclaration>),
    /// Handler of the timeout of the phase before it: `on timeout { ... }`. Part of that phase in a
    /// finished tree.
    Handler(Box<TimeoutHandler>),
    /// Shortest duration of a phase, or pause of a handler: `wait 20 s`
    Wait(Quantity),
    /// Repetition in a handler: `retry 3`
    Retry(Box<Expr>),
    /// Seed plate: `seed plate 3 x 3 { ... }`
    Seed(Box<Seed>),
    /// Pattern: `pattern tower(base, height) { ... }`
    Pattern(Box<Pattern>),
    /// Assembly: `assembly five_tower { ... }`
    Assembly(Box<Assembly>),
    /// Aggregate: `aggregate four in tank to 4`
    Aggregate(Box<Aggregate>),
    /// Shape: `shape bridge { ... }`
    Shape(Box<Shape>),
    /// Scene: `scene tank { ... }`
    Scene(Box<SceneDeclaration>),
    /// Import of a file: `import "towers.sa"`
    Import(Box<Import>),
}

/// A word with its location.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name {
    /// The word as a symbol.
    pub symbol: Symbol,
    /// Location of the word.
    pub span: Span,
}

/// Captures in a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// First parent, with its face.
    pub head: Place,
    /// Captured blocks in order. Never empty.
    pub links: Vec<Link>,
    /// Events that the first capture waits for.
    pub after: Vec<EventReference>,
}

/// An arrow of a chain with the captured blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Kind of the arrow.
    pub arrow: Arrow,
    /// Captured blocks, with the face that captures next.
    pub place: Place,
}

/// The two arrows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrow {
    /// Arrow `->`, which captures one block.
    One,
    /// Arrow `->>`, which captures all blocks of a range in a row. Each block captures the next one
    /// by the same face.
    Row,
}

/// An event to wait for.
#[derive(Clone, Debug, PartialEq)]
pub struct EventReference {
    /// Whether the event waits for the release of the block instead of its capture.
    pub release: bool,
    /// Block of the event.
    pub place: Place,
}

/// A release of blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Release {
    /// Blocks to release.
    pub places: Vec<Place>,
    /// Events that the releases wait for.
    pub after: Vec<EventReference>,
    /// Time between these events and the releases. `None` without a delay.
    pub delay: Option<Box<Quantity>>,
}

/// A block or several blocks, with a face if one is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Path from the outermost pattern instance to the name.
    pub path: SmallVec<[Segment; 1]>,
    /// Face at the end, with its location.
    pub face: Option<(Face, Span)>,
    /// Range of the whole path.
    pub span: Span,
}

/// A name of a path, with its indices.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Name without its index.
    pub name: Name,
    /// Indices. `None` if there are none.
    pub index: Option<Box<[Subscript]>>,
}

/// An index: a number or a range.
#[derive(Clone, Debug, PartialEq)]
pub enum Subscript {
    /// Single index: `[2]`
    One(Expr),
    /// Range of indices, both ends included: `[1..12]`
    Range(Expr, Expr),
}

/// An instance of a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Name of the pattern.
    pub pattern: Name,
    /// Values of the parameters.
    pub arguments: Vec<Argument>,
    /// Position of the instance. `None` if none is written.
    pub placement: Option<Box<Placement>>,
    /// Name of the instance. Statements outside use it for the blocks inside.
    pub alias: Option<Place>,
}

/// An argument of a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Name of the parameter. `None` if the position of the argument decides.
    pub name: Option<Name>,
    /// Value of the argument.
    pub value: ArgumentValue,
}

/// Value of an argument.
#[derive(Clone, Debug, PartialEq)]
pub enum ArgumentValue {
    /// A number, a face, or a bare name of any kind.
    Expr(Expr),
    /// A block, possibly with a face.
    Place(Place),
}

/// Position of an instance. The instance is mirrored, then turned, then moved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placement {
    /// Whether east and west are exchanged.
    pub mirrored: bool,
    /// Angle from east to north in degrees. `None` without a turn.
    pub turned: Option<Expr>,
    /// Number of blocks to the east and to the north. `None` without a move.
    pub at: Option<(Expr, Expr)>,
}

/// A seed of the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Seat {
    /// Name of the seed.
    pub place: Place,
    /// Position of the seed: number of blocks east and north of the plate's south-west block.
    pub at: (Expr, Expr),
}

/// A `for` loop.
#[derive(Clone, Debug, PartialEq)]
pub struct For {
    /// Name of the counter.
    pub counter: Name,
    /// First and last value, both included.
    pub range: (Expr, Expr),
    /// Statements of the loop.
    pub body: Vec<Item>,
}

/// Statements under a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct If {
    /// Whether the block begins with `else`. It is then used only if the conditions of the blocks
    /// before it are false.
    pub is_else: bool,
    /// Condition. `None` for an `else` without an `if`.
    pub condition: Option<Expr>,
    /// Statements of the block.
    pub body: Vec<Item>,
}

/// A number or a face with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Name of the value.
    pub name: Name,
    /// The value.
    pub value: Expr,
}

/// A statement that sets the level of a warning in the block around it.
#[derive(Clone, Debug, PartialEq)]
pub struct LintDirective {
    /// Level of the warning.
    pub verdict: LintDirectiveKind,
    /// Code of the warning, including hyphens.
    pub code: Name,
    /// Reason in quotation marks. Empty if the reason is missing, which is an error.
    pub reason: String,
}

/// Level of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LintDirectiveKind {
    /// The warning is not reported.
    Allow,
    /// The warning is an error.
    Deny,
}

/// A stage of the construction.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseDeclaration {
    /// Name of the phase, with an index inside a loop.
    pub name: Place,
    /// Time limit of the phase. `None` without a limit.
    pub timeout: Option<Quantity>,
    /// Statements of the phase.
    pub body: Vec<Item>,
    /// Handler of the timeout. `None` if a timeout ends the run.
    pub handler: Option<Box<TimeoutHandler>>,
}

/// Statements after the timeout of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeoutHandler {
    /// Range from `on` to the closing brace.
    pub span: Span,
    /// Statements of the handler.
    pub body: Vec<Item>,
}

/// The seed plate with its seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Seed {
    /// Number of blocks from west to east and from south to north.
    pub size: (Expr, Expr),
    /// Seeds, and captures of pre-attached blocks.
    pub body: Vec<Item>,
}

/// Statements that can be used several times.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Name of the pattern.
    pub name: Name,
    /// Parameters of the pattern.
    pub parameters: Vec<Parameter>,
    /// Statements of the pattern.
    pub body: Vec<Item>,
}

/// A parameter of a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name of the parameter.
    pub name: Name,
    /// Default value. `None` for a parameter that needs an argument.
    pub default: Option<Expr>,
}

/// A claim about the structure at the end of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YieldsClaim {
    /// Name of the shape.
    pub shape: Name,
    /// Whether the structure may have further blocks.
    pub at_least: bool,
}

/// An assembly program.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// Name of the assembly.
    pub name: Name,
    /// Parameters with their default values.
    pub parameters: Vec<Let>,
    /// Name of its scene. `None` for the default scene.
    pub scene: Option<Name>,
    /// Plate, phases and declarations.
    pub body: Vec<Item>,
}

/// Free blocks that bond to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Aggregate {
    /// Name of the aggregate.
    pub name: Name,
    /// Name of its scene. `None` for the default scene.
    pub scene: Option<Name>,
    /// Number of bonded blocks in a complete aggregate.
    pub size: Expr,
    /// Time limit of each phase. A phase ends when the largest group has grown by one block. `None`
    /// without a limit.
    pub timeout: Option<Quantity>,
}

/// A claim about the runs of an assembly.
#[derive(Clone, Debug, PartialEq)]
pub enum Expectation {
    /// Probability of an event: `complete with probability >= 0.95`
    Probability {
        /// The event.
        event: ExpectedEvent,
        /// Time limit for the event.
        within: Option<Quantity>,
        /// Relation of the probability to the bound.
        relation: Relation,
        /// Bound of the probability.
        bound: Quantity,
    },
    /// Mean completion time: `mean completion <= 7000 ticks`
    Mean {
        /// Relation of the mean to the bound.
        relation: Relation,
        /// Bound of the mean.
        bound: Quantity,
    },
    /// Comparison of means: `faster than five_tower by 20 %`
    Faster {
        /// Name of the other program.
        than: Name,
        /// Smallest relative difference. `None` for any difference.
        by: Option<Quantity>,
    },
}

/// An event of a claim.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpectedEvent {
    /// The program completes.
    Complete,
    /// A phase ends.
    Phase(Place),
    /// A block is captured by another block.
    Captured {
        /// Captured block.
        block: Place,
        /// Capturing block.
        by: Place,
    },
}

/// A target structure as layers of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Name of the shape.
    pub name: Name,
    /// South-west corner of every layer. `None` for (0, 0).
    pub at: Option<(Expr, Expr)>,
    /// Layers of the shape.
    pub layers: Vec<Layer>,
}

/// A layer of a shape, or several equal ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Heights above the plate.
    pub heights: Subscript,
    /// Range from `layer` to the closing brace.
    pub span: Span,
    /// Rows from north to south.
    pub rows: Vec<LayerRow>,
}

/// A row of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerRow {
    /// Cells from west to east. `true` for a block.
    pub cells: Vec<bool>,
    /// Range of the row.
    pub span: Span,
}

/// A scene as written. The compiler interprets its words.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDeclaration {
    /// Name of the scene.
    pub name: Name,
    /// Name of its base scene. `None` without a base.
    pub base: Option<Name>,
    /// Words and values between the braces.
    pub terms: Vec<Term>,
}

/// A word or value of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// Bare word: `restitution`
    Word(Name),
    /// Number with a unit: `20cm`
    Quantity(Quantity),
    /// Range: `0 .. 0.4 m/s`. A first value without a unit has the unit of the second value.
    Range(Quantity, Quantity),
    /// Terms in braces: `{ ... }`
    Block(Vec<Term>, Span),
}

/// A value with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The number as written.
    pub value: f64,
    /// Factors of the unit. Empty for a pure number.
    pub unit: Vec<UnitFactor>,
    /// Range of the value.
    pub span: Span,
}

/// A factor of a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitFactor {
    /// Name of the unit with its prefix, such as `mPa`.
    pub symbol: String,
    /// Exponent. Negative after a `/`.
    pub power: i8,
}

/// An import of the declarations of another file.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// Path as written, relative to the importing file.
    pub path: String,
    /// Location of the path.
    pub path_span: Span,
}

/// An integer expression, a face or a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Content of the expression.
    pub kind: ExprKind,
    /// Range of the expression.
    pub span: Span,
}

/// Content of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// Number: `6`
    Int(i64),
    /// Name of a number or a face: `n`
    Name(Symbol),
    /// Face: `east`
    Face(Face),
    /// Negation: `-n`
    Negate(Box<Expr>),
    /// Operation: `n + 1`
    Binary(Operator, Box<(Expr, Expr)>),
    /// Function: `min(n, 4)`
    Call(Function, Vec<Expr>),
    /// Negated condition: `not (n > 2)`
    Not(Box<Expr>),
}

/// Functions of integers and of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Smallest argument.
    Min,
    /// Largest argument.
    Max,
    /// Absolute value of the only argument.
    Abs,
    /// Opposite face.
    Opposite,
    /// Face to the left of a horizontal face, seen from above.
    Left,
    /// Face to the right of a horizontal face, seen from above.
    Right,
}

impl Function {
    /// All functions.
    pub const ALL: [Function; 6] = [
        Function::Min,
        Function::Max,
        Function::Abs,
        Function::Opposite,
        Function::Left,
        Function::Right,
    ];

    /// Returns the name of the function.
    pub const fn word(self) -> &'static str {
        match self {
            Function::Min => "min",
            Function::Max => "max",
            Function::Abs => "abs",
            Function::Opposite => "opposite",
            Function::Left => "left",
            Function::Right => "right",
        }
    }

    /// Returns the result for these arguments. Returns `None` on overflow or without arguments.
    pub fn apply(self, arguments: &[i64]) -> Option<i64> {
        let arguments = arguments.iter().copied();
        match self {
            Function::Min => arguments.min(),
            Function::Max => arguments.max(),
            Function::Abs => arguments.last()?.checked_abs(),
            Function::Opposite | Function::Left | Function::Right => None,
        }
    }

    /// Returns whether the argument and the result are faces. Otherwise they are numbers.
    pub const fn takes_face(self) -> bool {
        matches!(self, Function::Opposite | Function::Left | Function::Right)
    }

    /// Returns the result for a face. Returns `None` if there is none.
    pub fn apply_to_face(self, face: Face) -> Option<Face> {
        match self {
            Function::Opposite => Some(face.opposite()),
            Function::Left => face.turned(1),
            Function::Right => face.turned(3),
            Function::Min | Function::Max | Function::Abs => None,
        }
    }

    /// Returns whether the function has exactly one argument.
    pub(crate) const fn is_unary(self) -> bool {
        !matches!(self, Function::Min | Function::Max)
    }
}

/// Operators, with the usual precedence of arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Addition: `+`
    Add,
    /// Subtraction: `-`
    Subtract,
    /// Multiplication: `*`
    Multiply,
    /// Division, rounded towards zero: `/`
    Divide,
    /// Remainder of [`Operator::Divide`]: `%`
    Remainder,
    /// Equal: `==`
    Equal,
    /// Not equal: `!=`
    NotEqual,
    /// Less: `<`
    Less,
    /// Less or equal: `<=`
    LessOrEqual,
    /// Greater: `>`
    Greater,
    /// Greater or equal: `>=`
    GreaterOrEqual,
    /// Both conditions: `and`
    And,
    /// At least one condition: `or`
    Or,
}

impl Operator {
    /// Returns the result of the operation: 0 or 1 for conditions. Returns `None` on overflow or
    /// division by zero.
    pub fn apply(self, left: i64, right: i64) -> Option<i64> {
        match self {
            Operator::Add => left.checked_add(right),
            Operator::Subtract => left.checked_sub(right),
            Operator::Multiply => left.checked_mul(right),
            Operator::Divide => left.checked_div(right),
            // The remainder of the smallest number by -1 is 0, though the quotient does not fit.
            Operator::Remainder => (right != 0).then(|| left.wrapping_rem(right)),
            Operator::Equal => Some((left == right).into()),
            Operator::NotEqual => Some((left != right).into()),
            Operator::Less => Some((left < right).into()),
            Operator::LessOrEqual => Some((left <= right).into()),
            Operator::Greater => Some((left > right).into()),
            Operator::GreaterOrEqual => Some((left >= right).into()),
            Operator::And => Some((left != 0 && right != 0).into()),
            Operator::Or => Some((left != 0 || right != 0).into()),
        }
    }
}

impl LintDirectiveKind {
    /// Returns the keyword of the level.
    pub const fn word(self) -> &'static str {
        match self {
            LintDirectiveKind::Allow => "allow",
            LintDirectiveKind::Deny => "deny",
        }
    }
}

impl Operator {
    /// Returns the operator as written.
    pub const fn sign(self) -> &'static str {
        match self {
            Operator::Add => "+",
            Operator::Subtract => "-",
            Operator::Multiply => "*",
            Operator::Divide => "/",
            Operator::Remainder => "%",
            Operator::Equal => "==",
            Operator::NotEqual => "!=",
            Operator::Less => "<",
            Operator::LessOrEqual => "<=",
            Operator::Greater => ">",
            Operator::GreaterOrEqual => ">=",
            Operator::And => "and",
            Operator::Or => "or",
        }
    }

    /// Returns the precedence. Operators with a higher precedence bind tighter. All operators
    /// associate to the left.
    pub const fn precedence(self) -> u8 {
        match self {
            Operator::Or => 1,
            Operator::And => 2,
            Operator::Equal
            | Operator::NotEqual
            | Operator::Less
            | Operator::LessOrEqual
            | Operator::Greater
            | Operator::GreaterOrEqual => 3,
            Operator::Add | Operator::Subtract => 4,
            Operator::Multiply | Operator::Divide | Operator::Remainder => 5,
        }
    }

    /// Returns whether the operands are conditions.
    pub(crate) const fn joins_conditions(self) -> bool {
        matches!(self, Operator::And | Operator::Or)
    }

    /// Returns whether the result is a condition.
    pub(crate) const fn is_condition(self) -> bool {
        self.precedence() <= Operator::Equal.precedence()
    }
}

impl Expr {
    /// Returns whether the expression is a condition. Otherwise it is a number.
    pub(crate) const fn is_condition(&self) -> bool {
        match &self.kind {
            ExprKind::Binary(operator, _) => operator.is_condition(),
            ExprKind::Not(_) => true,
            _ => false,
        }
    }
}

impl Item {
    /// Returns whether the item contains the same kinds of items as the block around it.
    pub const fn is_transparent(&self) -> bool {
        matches!(self.kind, ItemKind::For(_) | ItemKind::If(_))
    }

    /// Returns the statements of a block. Returns `None` for items without a block.
    pub(crate) fn body_mut(&mut self) -> Option<&mut Vec<Item>> {
        match &mut self.kind {
            ItemKind::For(block) => Some(&mut block.body),
            ItemKind::If(block) => Some(&mut block.body),
            ItemKind::Phase(block) => Some(&mut block.body),
            ItemKind::Handler(block) => Some(&mut block.body),
            ItemKind::Seed(block) => Some(&mut block.body),
            ItemKind::Pattern(block) => Some(&mut block.body),
            ItemKind::Assembly(block) => Some(&mut block.body),
            _ => None,
        }
    }

    /// Returns the statements of a block, or no statements.
    pub fn body(&self) -> &[Item] {
        match &self.kind {
            ItemKind::For(block) => &block.body,
            ItemKind::If(block) => &block.body,
            ItemKind::Phase(block) => &block.body,
            ItemKind::Handler(block) => &block.body,
            ItemKind::Seed(block) => &block.body,
            ItemKind::Pattern(block) => &block.body,
            ItemKind::Assembly(block) => &block.body,
            _ => &[],
        }
    }

    /// Returns the kind of the item as a noun for messages.
    pub fn noun(&self) -> &'static str {
        match &self.kind {
            ItemKind::Chain(_) => "a capture",
            ItemKind::Release(_) => "a release",
            ItemKind::Instance(_) => "an instance of a pattern",
            ItemKind::Seat(_) => "a seed",
            ItemKind::For(_) => "a loop",
            ItemKind::If(block) if block.is_else => "an `else`",
            ItemKind::If(_) => "an `if`",
            ItemKind::Let(_) => "a `let`",
            ItemKind::Yields(_) => "a `yields`",
            ItemKind::Expect(_) => "an `expect`",
            ItemKind::Level(level) => match level.verdict {
                LintDirectiveKind::Allow => "an `allow`",
                LintDirectiveKind::Deny => "a `deny`",
            },
            ItemKind::Phase(_) => "a phase",
            ItemKind::Handler(_) => "an `on timeout`",
            ItemKind::Wait(_) => "a `wait`",
            ItemKind::Retry(_) => "a `retry`",
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
