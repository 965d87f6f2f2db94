//! Limits of sources.

/// Largest depth of blocks, and of parentheses.
pub const MAX_DEPTH: usize = 100;

/// Largest number of operands in an expression. Limits the recursion of its evaluation.
pub const MAX_TERMS: usize = 1_000;

/// Largest number of bytes of a statement.
pub const MAX_STATEMENT: usize = 4 << 20;

/// Largest number of errors that are reported for a file.
pub const MAX_ERRORS: usize = 100;
