//! A program with all its safe fixes.
use std::sync::Arc;

use crate::checked::Checked;
use crate::diagnostic::TextChange;
use crate::lint_levels::LintLevels;
use crate::program::check_with;
use crate::reader::Reader;
use crate::{FileId, Limits, trial};

/// Rounds of checking and changing, at most: each change may make room for another.
const MAX_ROUNDS: usize = 50;

/// What a file is with its safe fixes.
#[derive(Debug)]
pub struct Fixed {
    /// The text; without a mark of the byte order.
    pub text: Arc<str>,
    /// How many fixes that took.
    pub changes: usize,
    /// What was found before the first of them.
    pub before: Checked,
    /// The check after the last of them; `None` if there are none.
    pub after: Option<Checked>,
}

/// Works out all safe fixes of the file at `path`; those of files that it imports are left to them.
///
/// A round makes the fixes that fit together and leaves nothing new behind. Each has been tried
/// alone; where they do not go together, the first half of them is tried.
pub fn fix(path: &str, reader: &mut dyn Reader, limits: Limits, levels: &LintLevels) -> Fixed {
    let mut again = |texts: &mut dyn Reader| check_with(path, texts, limits, levels);
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

/// The program with as many of its safe fixes as go together, and how many; `None` if none is left.
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
