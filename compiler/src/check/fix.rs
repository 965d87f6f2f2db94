//! Applies all safe fixes of a file.
use std::sync::Arc;

use crate::check::changes::Changes;
use crate::check::checked::Checked;
use crate::check::program::check_changed;
use crate::check::trial;
use crate::diagnostic::TextChange;
use crate::diagnostic::lint_levels::LintLevels;
use crate::sources::reader::Reader;
use crate::{FileId, Limits};

/// Largest number of rounds of fixes. A fix may make another fix possible.
const MAX_ROUNDS: usize = 50;

/// A file after its safe fixes were applied.
#[derive(Debug)]
pub struct Fixed {
    /// The source, without a byte-order mark.
    pub text: Arc<str>,
    /// Number of applied fixes.
    pub changes: usize,
    /// Result of the check before the first fix.
    pub before: Checked,
    /// Result of the check after the last fix. `None` if there are no fixes.
    pub after: Option<Checked>,
}

/// Applies all safe fixes of the file at `path`. Its imports stay unchanged.
///
/// The checks use the values in `changes`. Each round applies fixes that do not overlap and that passed a trial alone. If they cause new
/// diagnostics together, the round tries only the first half of them.
pub fn fix(
    path: &str,
    reader: &mut dyn Reader,
    limits: Limits,
    levels: &LintLevels,
    changes: Changes<'_>,
) -> Fixed {
    let mut again = |texts: &mut dyn Reader| check_changed(path, texts, limits, levels, changes);
    let before = again(reader);
    let mut now: Option<Checked> = None;
    let mut changes = 0;
    for _ in 0..MAX_ROUNDS {
        let Some((next, count)) = round(now.as_ref().unwrap_or(&before), reader, &mut again) else {
            break;
        };
        changes += count;
        now = Some(next);
    }
    let last = now.as_ref().unwrap_or(&before);
    let text = last.sources.files().first().map(|file| file.text.clone());
    Fixed {
        text: text.unwrap_or_default(),
        changes,
        before,
        after: now,
    }
}

/// Applies one round of safe fixes. Returns the check of the changed program, and the number of
/// applied fixes. Returns `None` if no safe fix remains.
fn round(
    now: &Checked,
    reader: &mut dyn Reader,
    again: &mut dyn FnMut(&mut dyn Reader) -> Checked,
) -> Option<(Checked, usize)> {
    const OWN: FileId = FileId(0);
    let text = &now.sources.files().first()?.text;
    let fix = |number: usize| now.diagnostics[number].fix.as_ref().filter(|fix| fix.safe);
    let is_safe = |&number: &usize| fix(number).is_some();
    let safe: Vec<usize> = (0..now.diagnostics.len()).filter(is_safe).collect();
    let mut most = safe.len();
    while most > 0 {
        let mut change = TextChange::new(OWN, text);
        let fits = |number: &usize| fix(*number).is_some_and(|fix| change.add(fix));
        let fixed: Vec<usize> = safe[..most].iter().copied().filter(fits).collect();
        if fixed.is_empty() {
            return None;
        }
        let next = again(&mut change.over(&now.sources, reader));
        if trial::resolves(now, &fixed, &change, &next) {
            return Some((next, fixed.len()));
        }
        most /= 2;
    }
    None
}
