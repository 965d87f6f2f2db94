//! Renaming of names, without any change of meaning.
use std::collections::{BTreeMap, HashMap};

use gen_lsp_types::{TextEdit, Uri, WorkspaceEdit};
use stochc_compiler::diagnostic::Code;
use stochc_compiler::names::{Definition, NameKind, Names};
use stochc_compiler::{Cancellation, Checked, Limits, SourceLocation, check_cancellable};
use stochc_grammar::{Symbols, parse_cancellable};
use stochc_ir::scene::Scene;

use super::definition::{FileRange, everywhere};
use crate::wire::RequestFailure;
use crate::workspace::analysis::Analysis;
use crate::workspace::documents::Documents;

/// Returns the name at a byte of a program's own file, if it can be changed.
///
/// # Errors
///
/// If no name is at the byte, or the program does not define the name.
pub fn renameable(analysis: &Analysis, at: usize) -> Result<SourceLocation, RequestFailure> {
    let Some(name) = analysis.name_at(at) else {
        return Err(RequestFailure::request_failed("no name at this position"));
    };
    let names = &analysis.names;
    let declared = names
        .occurrences_of(name.definition)
        .any(|occurrence| occurrence.declares);
    if !declared {
        let word = analysis.checked.symbols.word(names.word(name.definition));
        return Err(RequestFailure::request_failed(
            match names.kind(name.definition) {
                NameKind::Scene => format!("the scene `{word}` is built in"),
                kind => format!("cannot find {} `{word}`", kind.noun()),
            },
        ));
    }
    Ok(name.location)
}

/// Returns the edits that rename a name in all programs that use it. The name is at a byte of a
/// program's own file.
///
/// # Errors
///
/// If the name cannot be changed, is invalid, or would have another meaning anywhere.
pub fn rename(
    analysis: &Analysis,
    all: &[&Analysis],
    at: usize,
    new_name: &str,
    documents: &Documents,
    cancellation: Cancellation<'_>,
) -> Result<WorkspaceEdit, RequestFailure> {
    let location = renameable(analysis, at)?;
    check_name(new_name)?;
    let path = analysis.path(location.file).to_owned();
    let from = (path, location.span.start, location.span.end);
    let places = everywhere(all, from, cancellation)?;
    let mut by_file: BTreeMap<&str, Vec<&FileRange>> = BTreeMap::new();
    for place in &places {
        by_file.entry(&place.0).or_default().push(place);
    }
    let concerned =
        |analysis: &&&Analysis| by_file.keys().any(|path| analysis.file(path).is_some());
    for analysis in all.iter().filter(concerned) {
        stays_the_same(analysis, &by_file, new_name, cancellation)?;
    }
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for (path, places) in &by_file {
        let Some((analysis, file)) =
            (all.iter()).find_map(|analysis| Some((analysis, analysis.file(path)?)))
        else {
            continue;
        };
        let lines = analysis.lines(file);
        let edits = places.iter().map(|(_, start, end)| TextEdit {
            range: lines.range(stochc_compiler::Span::new(*start, *end)),
            new_text: new_name.to_owned(),
        });
        changes.insert(documents.uri(path).into(), edits.collect());
    }
    Ok(WorkspaceEdit {
        changes: Some(changes),
        ..WorkspaceEdit::default()
    })
}

fn check_name(name: &str) -> Result<(), RequestFailure> {
    let is_letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let rest = |c: char| is_letter(c) || c.is_ascii_digit();
    if !name.starts_with(is_letter) || !name.chars().all(rest) {
        return Err(RequestFailure::request_failed(
            "a name consists of letters, digits and `_`, and does not begin with a digit",
        ));
    }
    let symbols = Symbols::new();
    match symbols.get(name) {
        Some(_) => Err(RequestFailure::request_failed(format!(
            "`{name}` is a keyword"
        ))),
        None => Ok(()),
    }
}

/// Checks the new name: every name must have the same definition as before, and no new diagnostic
/// may appear.
fn stays_the_same(
    analysis: &Analysis,
    places: &BTreeMap<&str, Vec<&FileRange>>,
    new_name: &str,
    cancellation: Cancellation<'_>,
) -> Result<(), RequestFailure> {
    let old = &analysis.checked;
    let mut texts: BTreeMap<&str, String> = BTreeMap::new();
    for file in old.sources.files() {
        let parsed = parse_cancellable(&file.text, &mut Symbols::new(), cancellation)?;
        if !parsed.errors.is_empty() {
            let why = format!("`{}` has syntax errors; fix them first", file.name);
            return Err(RequestFailure::request_failed(why));
        }
        let mut text = String::new();
        let mut done = 0;
        for (_, start, end) in places.get(file.name.as_str()).into_iter().flatten() {
            text.push_str(file.text.get(done..*start as usize).unwrap_or_default());
            text.push_str(new_name);
            done = *end as usize;
        }
        text.push_str(file.text.get(done..).unwrap_or_default());
        texts.insert(&file.name, text);
    }
    let Some(root) = old.sources.files().first() else {
        return Ok(());
    };
    let mut reader = |path: &str| match texts.get(path) {
        Some(text) => Ok(text.clone().into_bytes()),
        None => Err(std::io::Error::other("not read before")),
    };
    let new = check_cancellable(&root.name, &mut reader, Limits::EDITOR, cancellation)?;
    let names = Names::new(&new, cancellation)?;
    let is_same_structure = same_structure(&analysis.names, &names);
    let (before, after) = (scenes(old), scenes(&new));
    // Another scene causes other warnings, so this precedes the comparison of codes.
    if is_same_structure && before.len() == after.len() && before != after {
        let why = format!(
            "with a scene called `{new_name}`, assemblies without a scene would run in another one"
        );
        return Err(RequestFailure::request_failed(why));
    }
    if !is_same_structure || before != after || codes(old) != codes(&new) {
        let why = format!("`{new_name}` already has a meaning at one of these places");
        return Err(RequestFailure::request_failed(why));
    }
    Ok(())
}

/// Returns whether a renaming keeps the structure of the names. Two names must have a common
/// definition afterwards if and only if they had one before.
fn same_structure(old: &Names, new: &Names) -> bool {
    if old.all().len() != new.all().len() {
        return false;
    }
    let mut there: HashMap<Definition, Definition> = HashMap::new();
    let mut back: HashMap<Definition, Definition> = HashMap::new();
    old.all().iter().zip(new.all()).all(|(old, new)| {
        *there.entry(old.definition).or_insert(new.definition) == new.definition
            && *back.entry(new.definition).or_insert(old.definition) == old.definition
    })
}

fn codes(checked: &Checked) -> Vec<Code> {
    let mut codes: Vec<Code> = checked
        .diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .filter(|code| !concerns_names(*code))
        .collect();
    codes.sort_unstable();
    codes
}

/// Returns whether a diagnostic depends on a leading `_` of a name, or reports an unused `allow`.
fn concerns_names(code: Code) -> bool {
    matches!(
        code,
        Code::UnusedLet
            | Code::UnusedPattern
            | Code::UnusedShape
            | Code::UnusedScene
            | Code::UnusedAllow
    )
}

/// Returns the scene of each program, with the name of the scene removed.
fn scenes(checked: &Checked) -> Vec<Option<Scene>> {
    let nameless = |scene: &Scene| Scene {
        name: String::new(),
        ..scene.clone()
    };
    let scenes = checked
        .programs
        .iter()
        .map(|program| program.scene.as_ref());
    scenes.map(|scene| scene.map(nameless)).collect()
}
