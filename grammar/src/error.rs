use crate::Span;

/// A place where a text is not a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// What is wrong.
    pub kind: SyntaxErrorKind,
    /// Where.
    pub span: Span,
}

/// What is wrong with a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SyntaxErrorKind {
    /// Something else had to stand here.
    Unexpected {
        /// What stands here, shortened; empty at the end of the file.
        found: String,
        /// What could have stood here, in the language's own words; empty: nothing of the language.
        expected: Vec<&'static str>,
        /// The first word of the statement, if it is all of it that could be read; else empty.
        behind: String,
    },
    /// A block without its closing brace; the span is its opening one.
    Unclosed,
    /// The head of a block without its opening brace; the span is the place of the brace.
    MissingBrace {
        /// What the block is.
        what: &'static str,
    },
    /// A closing brace without a block.
    Unopened,
    /// A closing brace too many, behind which the block goes on.
    ClosedEarly {
        /// What the block is.
        what: &'static str,
    },
    /// A statement or block that belongs elsewhere.
    Misplaced {
        /// What it is.
        what: &'static str,
        /// What it stands in.
        within: &'static str,
        /// Where it belongs.
        belongs: &'static str,
        /// Whether the grammar has a place for it, so that it is in the tree all the same.
        is_read: bool,
    },
    /// Parentheses round the list behind a word of the language; the span is from one to the other.
    Parentheses {
        /// The word.
        word: String,
    },
    /// A unit in a scene without a number before it.
    MissingNumber,
    /// A word of the language used as a name.
    ReservedWord {
        /// The word.
        word: String,
    },
    /// A face where a block is meant, or the other way round.
    FaceMisused {
        /// What to write instead.
        hint: &'static str,
    },
    /// An integer beyond 64 bits, or a number of a scene beyond double precision.
    NumberTooLarge,
    /// Blocks or parentheses nested deeper than [`crate::MAX_DEPTH`].
    TooDeep,
    /// More than [`crate::MAX_TERMS`] numbers and names in one expression.
    TooManyTerms,
    /// A single statement longer than [`crate::MAX_STATEMENT`] bytes.
    StatementTooLong,
    /// An `allow` or `deny` that does not say why; the span is its code.
    MissingReason,
    /// Nothing for this comment to belong to.
    DanglingDoc,
    /// More than [`crate::MAX_ERRORS`] errors; the rest of the file was not read.
    TooMany,
    /// The file is JSON; the span is its first bracket.
    Json,
    /// A file of 4 GiB or more.
    FileTooLarge,
}

impl SyntaxErrorKind {
    /// Whether the grammar itself refuses the text. Where statements may stand, which names are taken, how large a number may be, and
    /// that a level has a reason, is not the grammar's to say.
    pub fn is_of_grammar(&self) -> bool {
        !matches!(
            self,
            SyntaxErrorKind::Misplaced { is_read: true, .. }
                | SyntaxErrorKind::ReservedWord { .. }
                | SyntaxErrorKind::FaceMisused { .. }
                | SyntaxErrorKind::DanglingDoc
                | SyntaxErrorKind::MissingReason
                | SyntaxErrorKind::NumberTooLarge
        )
    }
}
