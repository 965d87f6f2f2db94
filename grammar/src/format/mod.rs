//! Text to text, in the one canonical layout.
//!
//! Only what stands *between* tokens changes: every word, sign, number and comment stays as it is
//! written and where it is in their order, so the tree stays the same. The tokens come from the
//! parser itself, which is why there is no second notion of what a token is.
//!
//! The writer decides four things, and the layout keeps them: where a blank line stands (one at
//! most), whether a short block stands on one line, which seeds of a plate or words of a scene
//! share a line, and which words of a scene are set apart by a wider gap. All else follows from the tokens.
mod align;
mod block;
mod line;
mod scene;
mod source;
mod spacing;
mod statement;

use crate::error::SyntaxError;
use crate::parse::parse_recorded;
use crate::{Symbols, parse};

/// Columns that a line may have, unless a single word needs more.
pub(crate) const WIDTH: usize = 100;

/// Columns of one level of indentation.
pub(crate) const INDENT: usize = 4;

/// Why a text cannot be laid out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FormatError {
    /// It is no program.
    Wrong(Vec<SyntaxError>),
    /// The layout would have changed what the text says: a mistake of this crate, not of the text.
    Unfaithful,
}

/// Lays a text out.
///
/// The result parses to the same tree, holds the same comments in the same order (blanks at their
/// ends left out), and is its own layout. Lines end as the first line of the text does.
///
/// # Errors
///
/// If the text has errors of syntax; then nothing can be said of what belongs together.
pub fn format(text: &str) -> Result<String, FormatError> {
    let mut symbols = Symbols::new();
    let (parsed, record) = parse_recorded(text, &mut symbols);
    if !parsed.errors.is_empty() {
        return Err(FormatError::Wrong(parsed.errors));
    }
    let source = source::read(text, &record);
    let laid_out = block::lay_out(&source);
    // What is written over somebody's work is looked at twice.
    let again = parse(&laid_out, &mut symbols);
    if !again.errors.is_empty() || again.tree != parsed.tree {
        return Err(FormatError::Unfaithful);
    }
    let ends_in_return = |line: &str| line.ends_with('\r');
    Ok(match text.split_once('\n') {
        Some((first, _)) if ends_in_return(first) => laid_out.replace('\n', "\r\n"),
        _ => laid_out,
    })
}

/// Lays out what [`crate::print()`] has written, whether it makes sense or not.
pub(crate) fn lay_out(text: &str) -> Option<String> {
    let (parsed, record) = parse_recorded(text, &mut Symbols::new());
    // A misplaced statement is read all the same; what is left out would be missing here.
    let is_whole = |error: &SyntaxError| {
        use crate::SyntaxErrorKind as K;
        matches!(
            error.kind,
            K::Misplaced { is_read: true, .. } | K::ReservedWord { .. } | K::FaceMisused { .. }
        )
    };
    let whole = parsed.errors.iter().all(is_whole);
    whole.then(|| block::lay_out(&source::read(text, &record)))
}
