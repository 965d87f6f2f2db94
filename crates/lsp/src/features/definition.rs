//! Finds definitions and references.
use std::collections::BTreeSet;

use gen_lsp_types::Range;
use stochc_compiler::names::{NameKind, Occurrence};
use stochc_compiler::source_map::{Ancestry, blocks_at};
use stochc_compiler::{Cancellation, Cancelled, FileId, Limits, SourceLocation};
use stochc_grammar::tree::ItemKind;

use crate::workspace::analysis::Analysis;

/// Returns the declarations of the name at a byte: for a block, its seed or captures.
///
/// # Errors
///
/// [`Cancelled`] if the request is cancelled.
pub fn definitions(
    analysis: &Analysis,
    at: usize,
    cancellation: Cancellation<'_>,
) -> Result<Vec<SourceLocation>, Cancelled> {
    let Some(name) = analysis.name_at(at) else {
        return Ok(imported(analysis, at).into_iter().collect());
    };
    let names = &analysis.names;
    let declarations: Vec<SourceLocation> = (names.occurrences_of(name.definition))
        .filter(|occurrence| occurrence.declares)
        .map(|occurrence| occurrence.location)
        .collect();
    if names.kind(name.definition) != NameKind::Block {
        return Ok(declarations);
    }
    // Of all blocks with this word, only the ones that the name means.
    let mut locations: Vec<SourceLocation> = Vec::new();
    for location in introductions(analysis, at, cancellation)? {
        let end = location.span.end;
        let within = declarations.iter().filter(|declaration| {
            declaration.file == location.file
                && (location.span.start..end).contains(&declaration.span.start)
        });
        let last = within.max_by_key(|declaration| declaration.span.start);
        locations.extend(last.filter(|last| !locations.contains(last)));
    }
    Ok(if locations.is_empty() {
        declarations
    } else {
        locations
    })
}

/// Returns the seeds and captures of all blocks that the name at a byte can denote.
fn introductions(
    analysis: &Analysis,
    at: usize,
    cancellation: Cancellation<'_>,
) -> Result<Vec<SourceLocation>, Cancelled> {
    let mut locations = Vec::new();
    let place = (FileId(0), at as u32);
    for located in blocks_at(&analysis.checked, place, Limits::EDITOR, cancellation)? {
        let program = &analysis.checked.programs[located.program];
        let ancestry = Ancestry::new(program);
        for role in located.roles {
            let seeds = program.plan.seeds.iter().filter(|seed| seed.role == role);
            locations.extend(seeds.map(|seed| seed.location));
            let captures = ancestry.captures(role).iter();
            locations.extend(captures.map(|&capture| program.plan.event(capture).location));
        }
    }
    Ok(locations)
}

/// Returns the start of the file that is imported at a byte. Returns `None` if no file is imported
/// there.
fn imported(analysis: &Analysis, at: usize) -> Option<SourceLocation> {
    let (_, file) = imports(analysis)
        .find(|(path, _)| (path.span.start..=path.span.end).contains(&(at as u32)))?;
    let span = stochc_compiler::Span::new(0, 0);
    Some(SourceLocation { file, span })
}

/// Returns the paths of imports in the program's own file, with the imported files.
pub fn imports(analysis: &Analysis) -> impl Iterator<Item = (SourceLocation, FileId)> {
    let checked = &analysis.checked;
    checked.tree.items.iter().filter_map(|item| {
        let ItemKind::Import(import) = &item.kind else {
            return None;
        };
        let name = &checked.sources.file(FileId(0)).name;
        let file = analysis.file(&stochc_compiler::join_import(name, &import.path))?;
        let path = SourceLocation {
            file: FileId(0),
            span: import.path_span,
        };
        Some((path, file))
    })
}

/// Range in a file. The file is given by its path, so the range is valid in every program.
pub type FileRange = (String, u32, u32);

/// Returns all occurrences, in all programs, of the name at a location.
///
/// # Errors
///
/// If the request is cancelled.
pub fn everywhere(
    analyses: &[&Analysis],
    from: FileRange,
    cancellation: Cancellation<'_>,
) -> Result<BTreeSet<FileRange>, Cancelled> {
    let mut places = BTreeSet::from([from.clone()]);
    let mut waiting = vec![from];
    let mut done = BTreeSet::new();
    while let Some(place) = waiting.pop() {
        cancellation.check()?;
        for (number, analysis) in analyses.iter().enumerate() {
            let Some(name) = named_at(analysis, &place) else {
                continue;
            };
            if !done.insert((number, name.definition)) {
                continue;
            }
            for occurrence in analysis.names.occurrences_of(name.definition) {
                let span = occurrence.location.span;
                let path = analysis.path(occurrence.location.file);
                let found = (path.to_owned(), span.start, span.end);
                // Other programs may have further occurrences.
                if places.insert(found.clone()) && analyses.len() > 1 {
                    waiting.push(found);
                }
            }
        }
    }
    Ok(places)
}

/// Returns the name at a location. Returns `None` if the file is not part of a program, or has no
/// name there.
pub fn named_at<'a>(
    analysis: &'a Analysis,
    (path, start, _): &FileRange,
) -> Option<&'a Occurrence> {
    analysis.names.at(analysis.file(path)?, *start)
}

/// Returns the occurrences of the name at a byte in the program's own file, and whether each is a
/// declaration.
///
/// # Errors
///
/// [`Cancelled`] if the request is cancelled.
pub fn highlights(
    analysis: &Analysis,
    at: usize,
    cancellation: Cancellation<'_>,
) -> Result<Vec<(Range, bool)>, Cancelled> {
    let Some(name) = analysis.name_at(at) else {
        return Ok(Vec::new());
    };
    let own = FileId(0);
    let lines = analysis.lines(own);
    let places = analysis.names.occurrences_of(name.definition);
    places
        .filter(|occurrence| occurrence.location.file == own)
        .map(|occurrence| {
            cancellation.check()?;
            Ok((lines.range(occurrence.location.span), occurrence.declares))
        })
        .collect()
}
