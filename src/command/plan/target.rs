//! Reads what is to be built.
use std::path::Path;

use stochc_files::budget::VOXELS;
use stochc_files::programs::refusal;
use stochc_files::read_file;
use stochc_grammar::Symbols;
use stochc_ir::Cell;
use stochc_planner::{UnreadableVoxels, layers, magica_voxel};

use super::super::check::verdict;
use super::super::terminal::{has_colour, message_width, warn_drawn};
use super::Options;
use crate::diagnostics::drawn;
use crate::exit::{Exit, Failure};
use crate::planning::Goal;

/// The target of the command line.
pub fn read(options: &Options) -> Result<Goal, Failure> {
    let target = &options.target;
    let kind = Path::new(target).extension().and_then(|kind| kind.to_str());
    match kind {
        Some("vox") => voxels(options, magica_voxel),
        Some("txt") => voxels(options, |bytes| {
            let text = std::str::from_utf8(bytes);
            text.map_or_else(|_| layers("?"), layers)
        }),
        _ => program(options),
    }
}

fn voxels(
    options: &Options,
    cells: impl Fn(&[u8]) -> Result<Vec<Cell>, UnreadableVoxels>,
) -> Result<Goal, Failure> {
    let target = &options.target;
    if options.shape.is_some() {
        return Err(Failure::usage(
            "`--shape` is for programs: a file of voxels is one shape",
        ));
    }
    let bytes = read_file(Path::new(target), VOXELS)
        .map_err(|error| Failure::usage(format!("cannot read `{target}`: {error}")))?;
    let cells = cells(&bytes)
        .map_err(|error| Failure::wrong_program(format!("`{target}` is no target: {error}")))?;
    Ok(Goal::of_cells(&name(target), cells))
}

fn program(options: &Options) -> Result<Goal, Failure> {
    let target = &options.target;
    if let Some(reason) = refusal(target) {
        return Err(Failure::usage(reason));
    }
    let checked = crate::check_within(target, &Default::default(), &options.imports.folders);
    if checked.has_errors() {
        warn_drawn(&drawn(&checked, has_colour(), message_width()));
        return Err(Failure::silent(verdict(&checked)));
    }
    Goal::of_program(&checked, options.shape.as_deref())
        .map_err(|reason| Failure::error(Exit::WrongProgram, format!("`{target}`: {reason}")))
}

/// A name for the shape of a file: what of the file's name may stand in one.
fn name(target: &str) -> String {
    let stem = Path::new(target)
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or_default();
    let signs = stem.chars().map(|sign| {
        if sign.is_ascii_alphanumeric() {
            sign
        } else {
            '_'
        }
    });
    let name: String = signs.collect();
    let begins_well = name.starts_with(|first: char| first.is_ascii_alphabetic());
    // New symbols hold the words of the language.
    match begins_well && Symbols::new().get(&name).is_none() {
        true => name,
        false => format!("shape_{name}"),
    }
}
