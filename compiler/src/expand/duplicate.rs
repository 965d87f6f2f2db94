//! Errors of items that are declared twice.
use stochc_grammar::Symbols;

use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic, Fix};

/// Returns the plural of `a phase` or `an assembly`.
fn plural(noun: &str) -> String {
    let word = noun.split_once(' ').map_or(noun, |(_, word)| word);
    match word.strip_suffix('y') {
        Some(stem) => format!("{stem}ies"),
        None => format!("{word}s"),
    }
}

/// Returns the error for two declarations with the same name. Suggests an unused name for the
/// second declaration.
pub fn duplicate(
    name: &str,
    old: SourceLocation,
    new: SourceLocation,
    noun: &str,
    symbols: &Symbols,
) -> Diagnostic {
    let numbered = (2..100).map(|number| format!("{name}_{number}"));
    let other = numbered
        .into_iter()
        .find(|name| symbols.get(name).is_none());
    let mut diagnostic = Diagnostic::about(
        Code::DuplicateName,
        "two {} are named `{}`",
        &[&plural(noun), name],
    )
    .label(new, "second declaration")
    .label(old, "first declaration");
    // A name with an index cannot be replaced.
    let other = other.filter(|_| new.span.len() == name.len());
    let Some(other) = other else {
        return diagnostic.help("rename one of them");
    };
    let fix = Fix::replace(new, &other, format!("call it `{other}`"));
    diagnostic.fix = Some(fix.unsafe_if(true));
    diagnostic.help(format!("rename one of them, such as `{other}`"))
}
