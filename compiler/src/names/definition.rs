//! Definitions and uses of names.
use crate::SourceLocation;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Used as a value of this kind, at this location.
    As(ValueKind, SourceLocation),
    /// Passed as an argument to a pattern, for the parameter with this index.
    Argument(Definition, usize),
}

/// Kind of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ValueKind {
    Block,
    Number,
    Face,
}

impl ValueKind {
    pub const ALL: [ValueKind; 3] = [ValueKind::Block, ValueKind::Number, ValueKind::Face];

    /// Returns the words that messages use.
    pub const fn noun(self) -> &'static str {
        match self {
            ValueKind::Block => "a block",
            ValueKind::Number => "a number",
            ValueKind::Face => "a face",
        }
    }
}

/// Names whose occurrences are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    All,
    /// All names except names of blocks, instances and phases. There can be millions of those.
    Declarations,
}

/// A name at a source location.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occurrence {
    /// Location of the name.
    pub location: SourceLocation,
    /// Definition of the name.
    pub definition: Definition,
    /// Whether the name is declared here. Captures declare blocks.
    pub declares: bool,
}

/// Definition of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Definition(pub(super) u32);

/// Kind of a definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NameKind {
    /// Blocks of an assembly or a pattern.
    Block,
    /// Named instances of patterns.
    Instance,
    /// A `let`.
    Number,
    /// The counter of a loop.
    Counter,
    /// A parameter of a pattern.
    Parameter,
    /// A pattern.
    Pattern,
    /// A shape.
    Shape,
    /// A scene.
    Scene,
    /// An assembly.
    Assembly,
    /// An aggregate.
    Aggregate,
    /// Phases of an assembly.
    Phase,
}

impl NameKind {
    /// Returns whether the expansion looks up definitions of this kind here. The expansion resolves
    /// blocks, instances and phases itself.
    pub(super) const fn is_asked_for(self) -> bool {
        matches!(
            self,
            NameKind::Number
                | NameKind::Counter
                | NameKind::Parameter
                | NameKind::Pattern
                | NameKind::Shape
                | NameKind::Scene
        )
    }

    /// Returns the kind as a noun for messages.
    pub const fn noun(self) -> &'static str {
        match self {
            NameKind::Block => "block",
            NameKind::Instance => "instance of a pattern",
            NameKind::Number => "number",
            NameKind::Counter => "counter",
            NameKind::Parameter => "parameter",
            NameKind::Pattern => "pattern",
            NameKind::Shape => "shape",
            NameKind::Scene => "scene",
            NameKind::Assembly => "assembly",
            NameKind::Aggregate => "aggregate",
            NameKind::Phase => "phase",
        }
    }
}
