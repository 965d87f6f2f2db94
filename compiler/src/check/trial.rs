//! Tries fixes, and marks a fix as safe if it improves the program.
//!
//! A stage proposes a fix if the source at its location has only one possible meaning. A trial
//! applies the fix in memory and checks the whole program again. The command line and editors use
//! the same trials.
use std::collections::{BTreeSet, VecDeque};

use rustc_hash::FxHashMap;
use stochc_grammar::Cancelled;

use crate::check::checked::Checked;
use crate::diagnostic::{Code, Diagnostic, Severity, TextChange};
use crate::sources::reader::Reader;
use crate::{FileId, Sources};

/// Largest number of trials of a program.
const MAX: usize = 64;

/// Largest total size of all trials: bytes of source plus number of events.
const WORK: usize = 1 << 21;

/// Number of statements whose check takes as long as the check of one event.
pub(crate) const OF_AN_EVENT: usize = 16;

/// Function that checks a program again, with changed sources.
pub(crate) type Again<'a> = dyn FnMut(&mut dyn Reader) -> Result<Checked, Cancelled> + 'a;

/// Marks fixes as unsafe unless they pass a trial.
///
/// Fixes are tried one by one if this is fast enough for the size of the program. Otherwise all are
/// tried together, and in halves if that fails. Untried fixes are unsafe.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub(crate) fn verify_fixes(
    checked: &mut Checked,
    reader: &mut dyn Reader,
    again: &mut Again<'_>,
) -> Result<(), Cancelled> {
    let claimed = |(_, diagnostic): &(usize, &Diagnostic)| {
        let fix = diagnostic.fix.as_ref();
        fix.is_some_and(|fix| fix.safe && !fix.edits.is_empty())
    };
    let claims: Vec<usize> = (checked.diagnostics.iter().enumerate())
        .filter(claimed)
        .map(|(number, _)| number)
        .collect();
    if claims.is_empty() {
        return Ok(());
    }
    let mut left = MAX.min(WORK / size(checked).max(1));
    let mut safe = vec![false; checked.diagnostics.len()];
    let together = claims.len().div_ceil(left.max(1));
    let mut groups: VecDeque<Vec<usize>> =
        (claims.chunks(together).map(<[usize]>::to_vec)).collect();
    while let Some(mut group) = groups.pop_front() {
        if left == 0 {
            break;
        }
        left -= 1;
        let (tried, unfit) = try_together(checked, &group, reader, again)?;
        if !unfit.is_empty() && unfit.len() < group.len() {
            group.retain(|number| !unfit.contains(number));
            groups.push_back(unfit);
        }
        match tried {
            true => group.iter().for_each(|&number| safe[number] = true),
            false if group.len() > 1 => {
                let half = group.split_off(group.len() / 2);
                groups.extend([group, half]);
            }
            false => {}
        }
    }
    for (diagnostic, safe) in checked.diagnostics.iter_mut().zip(safe) {
        if let Some(fix) = &mut diagnostic.fix {
            fix.safe &= safe;
        }
    }
    Ok(())
}

/// Marks all fixes as unsafe.
pub(crate) fn distrust(checked: &mut Checked) {
    let fixes = checked
        .diagnostics
        .iter_mut()
        .filter_map(|it| it.fix.as_mut());
    fixes.for_each(|fix| fix.safe = false);
}

/// Returns the size of a checked program, in the unit of [`WORK`].
fn size(checked: &Checked) -> usize {
    let texts = checked.sources.files().iter().map(|file| file.text.len());
    let programs = checked.programs.iter();
    let plans = programs.map(|it| it.plan.events.len() + it.plan.steps / OF_AN_EVENT);
    texts.chain(plans).sum()
}

/// Tries several fixes together. Returns whether they remove their diagnostics and cause no new
/// ones. Also returns the fixes that overlap with other fixes.
fn try_together(
    checked: &Checked,
    group: &[usize],
    reader: &mut dyn Reader,
    again: &mut Again<'_>,
) -> Result<(bool, Vec<usize>), Cancelled> {
    let fix = |number: &usize| checked.diagnostics[*number].fix.as_ref();
    let first = group
        .first()
        .and_then(fix)
        .and_then(|fix| fix.edits.first());
    let Some(file) = first.map(|edit| edit.location.file) else {
        return Ok((false, Vec::new()));
    };
    let mut change = TextChange::new(file, &checked.sources.file(file).text);
    let (fit, unfit): (Vec<usize>, Vec<usize>) =
        (group.iter()).partition(|number| fix(number).is_some_and(|fix| change.add(fix)));
    let mut texts = change.over(&checked.sources, reader);
    let after = again(&mut texts)?;
    let resolves = !fit.is_empty() && resolves(checked, &fit, &change, &after);
    Ok((resolves, unfit))
}

/// Codes of diagnostics that report a reached limit.
const TOO_MANY: [Code; 2] = [Code::TooManyErrors, Code::TooManyWarnings];

/// Returns whether a change removes the fixed diagnostics, and leaves all others unchanged.
///
/// Two kinds of new diagnostics are accepted. Some warnings appear only when there are no errors.
/// If a limit of diagnostics was reached, further diagnostics of the same codes can appear.
pub(crate) fn resolves(
    before: &Checked,
    fixed: &[usize],
    change: &TextChange<'_>,
    after: &Checked,
) -> bool {
    let mut is_fixed = vec![false; before.diagnostics.len()];
    fixed.iter().for_each(|&number| is_fixed[number] = true);
    let diagnostics = || before.diagnostics.iter().zip(&is_fixed);
    if diagnostics().any(|(diagnostic, &is_fixed)| is_fixed && TOO_MANY.contains(&diagnostic.code))
    {
        return false;
    }
    let fixed_spans = diagnostics().filter(|&(_, &is_fixed)| is_fixed);
    let fixed_spans =
        DiagnosticSpans::new(&before.sources, fixed_spans.map(|(it, _)| it), Some(change));
    let all = DiagnosticSpans::new(&after.sources, after.diagnostics.iter(), None);
    let codes = |checked: &Checked| -> BTreeSet<Code> {
        checked.diagnostics.iter().map(|it| it.code).collect()
    };
    let known = codes(before);
    if TOO_MANY.iter().any(|code| known.contains(code)) {
        return after.diagnostics.len() <= before.diagnostics.len()
            && codes(after).is_subset(&known)
            && !fixed_spans.meet(&all);
    }
    let is_wrong = |diagnostic: &Diagnostic| diagnostic.code.severity() == Severity::Error;
    let fixes_error = diagnostics().any(|(diagnostic, &is_fixed)| is_fixed && is_wrong(diagnostic));
    let remaining = diagnostics().filter(|&(_, &is_fixed)| !is_fixed);
    let mut old = DiagnosticSpans::new(
        &before.sources,
        remaining.map(|(diagnostic, _)| diagnostic),
        Some(change),
    );
    let new = (after.diagnostics.iter()).filter(|diagnostic| is_wrong(diagnostic) || !fixes_error);
    let new = DiagnosticSpans::new(&after.sources, new, None);
    (new.0).into_iter().all(|(key, places)| {
        let Some(old) = old.0.get_mut(&key) else {
            return false;
        };
        // Both lists are sorted by location.
        let mut old = old.iter();
        (places.iter()).all(|place| old.any(|old| old.0 <= place.0 && place.1 <= old.1))
    })
}

/// Locations of diagnostics, by kind.
struct DiagnosticSpans<'a>(FxHashMap<Kind<'a>, Vec<(usize, usize)>>);

/// Kind of a diagnostic: its code and the name of its file.
type Kind<'a> = (Code, Option<&'a str>);

impl<'a> DiagnosticSpans<'a> {
    /// Returns whether a location of this set overlaps with a location of `others` that has the
    /// same code and file.
    fn meet(&self, others: &DiagnosticSpans<'_>) -> bool {
        self.0.iter().any(|(key, places)| {
            let others = others.0.get(key).map_or(&[][..], Vec::as_slice);
            let is_among = |other: &(usize, usize)| {
                (places.iter()).any(|place| place.0 <= other.0 && other.1 <= place.1)
            };
            others.iter().any(is_among)
        })
    }

    /// Returns the locations of diagnostics. If there is a `change`, converts them to positions
    /// after it.
    fn new(
        sources: &'a Sources,
        diagnostics: impl Iterator<Item = &'a Diagnostic>,
        change: Option<&TextChange<'_>>,
    ) -> DiagnosticSpans<'a> {
        let mut by_file: FxHashMap<(Code, Option<FileId>), Vec<usize>> = FxHashMap::default();
        for diagnostic in diagnostics {
            let location = diagnostic.labels.first().map(|label| label.location);
            let at = location.map_or(0, |location| location.span.start as usize);
            let key = (diagnostic.code, location.map(|location| location.file));
            by_file.entry(key).or_default().push(at);
        }
        let by_name = by_file.into_iter().map(|((code, file), mut places)| {
            places.sort_unstable();
            let carried = match change.filter(|change| Some(change.file()) == file) {
                Some(change) => change.carried(&places),
                None => places.into_iter().map(|at| (at, at)).collect(),
            };
            let name = file.map(|file| sources.file(file).name.as_str());
            ((code, name), carried)
        });
        DiagnosticSpans(by_name.collect())
    }
}
