//! Formats whole files.
use super::{block, source};
use crate::error::SyntaxError;
use crate::parse::parse_recorded;
use crate::{Symbols, parse};

/// Reason why a source cannot be formatted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FormatError {
    /// The source has syntax errors.
    Wrong(Vec<SyntaxError>),
    /// Formatting would change the meaning: a bug in this crate.
    Unfaithful,
}

/// Formats a source.
///
/// The result parses to the same tree and has the same comments in the same order. Formatting the
/// result again does not change it. All lines end in the same way as the first line of the source.
///
/// # Errors
///
/// Returns an error if the source has syntax errors.
pub fn format(text: &str) -> Result<String, FormatError> {
    let mut symbols = Symbols::new();
    let (parsed, record) = parse_recorded(text, &mut symbols);
    if !parsed.errors.is_empty() {
        return Err(FormatError::Wrong(parsed.errors));
    }
    let source = source::read(text, &record);
    let laid_out = block::lay_out(&source);
    // The result replaces the user's file, so it is checked twice.
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

/// Formats the output of [`crate::print()`], valid or not. Returns `None` if the grammar rejects
/// it.
pub(crate) fn lay_out(text: &str) -> Option<String> {
    let (parsed, record) = parse_recorded(text, &mut Symbols::new());
    // Misplaced statements must appear in the output, too.
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
