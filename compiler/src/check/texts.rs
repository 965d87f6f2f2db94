//! Checks sources that are held in memory.
use crate::check::changes::Changes;
use crate::check::checked::Checked;
use crate::check::model_check;
use crate::check::program::check_changed;
use crate::diagnostic::lint_levels::LintLevels;
use crate::expand::Limits;

/// Checks a text without imports. `name` is its file name in diagnostics.
///
/// ```
/// let checked = stochc_compiler::check_text("pair.sa", "assembly pair { seed plate 1 x 1 { M at (0, 0) }\nphase grow { N.up -> A } }");
/// assert!(checked.has_errors());
/// assert_eq!(checked.diagnostics[0].code.name(), "unknown-name");
/// ```
pub fn check_text(name: &str, text: &str) -> Checked {
    check_texts(&[(name, text)], &LintLevels::default(), Changes::NONE)
}

/// Checks texts in memory. The first text is the program's own file.
///
/// Also explores small programs [in every order of events](model_check).
pub fn check_texts(texts: &[(&str, &str)], levels: &LintLevels, changes: Changes<'_>) -> Checked {
    let mut reader = |path: &str| {
        let found = texts.iter().find(|(name, _)| *name == path);
        found
            .map(|(_, text)| text.as_bytes().to_vec())
            .ok_or_else(|| std::io::Error::other("it is not among the texts"))
    };
    let root = texts.first().map_or("", |(name, _)| name);
    let limits = Limits::default();
    let mut checked = check_changed(root, &mut reader, limits, levels, changes);
    model_check::try_out(&mut checked);
    checked
}
