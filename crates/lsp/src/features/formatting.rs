//! Formatting as text edits.
use std::time::Duration;

use gen_lsp_types::TextEdit;
use similar::{DiffOp, TextDiff};
use stochc_compiler::{FileId, Span, lone_returns};
use stochc_grammar::{FormatError, format};

use crate::wire::RequestFailure;
use crate::workspace::position::LineIndex;

/// Time limit for the exact comparison of the old and the new text. After this time, edits may
/// cover more lines than necessary.
const PATIENCE: Duration = Duration::from_secs(1);

const WRONG: &str = "the program has syntax errors; fix them first";

/// Returns the edits that format a text. Only changed lines are edited, so that editor marks such
/// as breakpoints survive on other lines.
///
/// # Errors
///
/// If the text has syntax errors.
pub fn edits(text: &str, lines: &LineIndex<'_>) -> Result<Vec<TextEdit>, RequestFailure> {
    if lone_returns(FileId(0), text).is_some() {
        return Err(RequestFailure::request_failed(WRONG));
    }
    let laid_out = format(text).map_err(|error| {
        RequestFailure::request_failed(match error {
            FormatError::Wrong(_) => WRONG,
            FormatError::Unfaithful => "formatting would change the program; please report this",
        })
    })?;
    // Lines as the language defines them: a lone `\r` does not end a line.
    let of = |text| str::split_inclusive(text, '\n').collect::<Vec<_>>();
    let (old_lines, new_lines) = (of(text), of(&laid_out));
    let diff = TextDiff::configure()
        .timeout(PATIENCE)
        .diff_slices(&old_lines, &new_lines);
    let starts = |lines: &[&str]| {
        let mut starts = vec![0];
        starts.extend(lines.iter().scan(0, |at, line| {
            *at += line.len();
            Some(*at)
        }));
        starts
    };
    let (old, new) = (starts(&old_lines), starts(&new_lines));
    let changed = diff
        .ops()
        .iter()
        .filter(|op| !matches!(op, DiffOp::Equal { .. }));
    Ok(changed
        .map(|op| {
            let (from, to) = (op.old_range(), op.new_range());
            TextEdit {
                range: lines.range(Span::new(old[from.start] as u32, old[from.end] as u32)),
                new_text: laid_out[new[to.start]..new[to.end]].to_owned(),
            }
        })
        .collect())
}
