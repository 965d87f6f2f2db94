use crate::Span;

/// A syntax error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Kind of the error.
    pub kind: SyntaxErrorKind,
    /// Location in the source.
    pub span: Span,
}

/// Kind of a syntax error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SyntaxErrorKind {
    /// A word or character that is not valid here.
    Unexpected {
        /// Source at this position, shortened. Empty at the end of the file.
        found: String,
        /// Alternatives that are valid here, as text. Empty if no statement can contain the word.
        expected: Vec<&'static str>,
        /// Word before the error, if it is the only word of the statement up to there. Otherwise
        /// empty.
        after: String,
    },
    /// A block without its closing brace. The span is the opening brace.
    Unclosed,
    /// The head of a block without its opening brace. The span is the position of the missing
    /// brace.
    MissingBrace {
        /// Kind of the block.
        what: &'static str,
    },
    /// A closing brace without a block.
    Unopened,
    /// A closing brace that ends a block, although more of the block follows.
    ClosedEarly {
        /// Kind of the block.
        what: &'static str,
    },
    /// A statement or block of statements inside braces that cannot contain it.
    Misplaced {
        /// Kind of the statement or block.
        what: &'static str,
        /// Kind of the block around the statement.
        within: &'static str,
        /// Phrase for the block that may contain the statement.
        belongs: &'static str,
        /// Whether the grammar accepts the statement. It is then in the tree.
        is_read: bool,
    },
    /// Parentheses around the list after a keyword. The span includes both parentheses.
    Parentheses {
        /// The keyword before the list.
        word: String,
    },
    /// A unit without a number before it.
    MissingNumber,
    /// A keyword used as a name.
    ReservedWord {
        /// The keyword.
        word: String,
    },
    /// A face where a block is required, or a block where a face is required.
    FaceMisused {
        /// Advice in the imperative.
        hint: &'static str,
    },
    /// A number where a condition is required.
    NumberAsCondition,
    /// A condition where a number is required.
    ConditionAsNumber,
    /// A function that does not exist, or with the wrong number of arguments. The span is its name.
    WrongFunction {
        /// Name of the function.
        word: String,
    },
    /// An integer beyond 64 bits, or a number of a scene beyond double precision.
    NumberTooLarge,
    /// Blocks or parentheses nested deeper than [`crate::MAX_DEPTH`].
    TooDeep,
    /// More than [`crate::MAX_TERMS`] numbers and names in one expression.
    TooManyTerms,
    /// A single statement longer than [`crate::MAX_STATEMENT`] bytes.
    StatementTooLong,
    /// An `allow` or `deny` without a reason. The span is the code of the warning.
    MissingReason,
    /// A `///` comment without a declaration or statement after it.
    DanglingDoc,
    /// More than [`crate::MAX_ERRORS`] errors. The rest of the file was not read.
    TooMany,
    /// The file is JSON. The span is its first bracket.
    Json,
    /// A file of 4 GiB or more.
    FileTooLarge,
}

impl SyntaxErrorKind {
    /// Returns whether the grammar itself rejects the source.
    ///
    /// Later checks find misplaced statements, reserved words as names, numbers beyond their
    /// limits, and levels without reasons.
    pub fn is_of_grammar(&self) -> bool {
        !matches!(
            self,
            SyntaxErrorKind::Misplaced { is_read: true, .. }
                | SyntaxErrorKind::ReservedWord { .. }
                | SyntaxErrorKind::FaceMisused { .. }
                | SyntaxErrorKind::DanglingDoc
                | SyntaxErrorKind::MissingReason
                | SyntaxErrorKind::NumberAsCondition
                | SyntaxErrorKind::ConditionAsNumber
                | SyntaxErrorKind::WrongFunction { .. }
                | SyntaxErrorKind::NumberTooLarge
        )
    }
}
