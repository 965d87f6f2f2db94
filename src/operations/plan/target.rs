//! Reads what is to be built.
use std::path::Path;

use stochc_compiler::Checked;
use stochc_compiler::diagnostic::{Code, Severity};
use stochc_files::budget::VOXELS;
use stochc_files::programs::not_a_file;
use stochc_files::read_file;
use stochc_grammar::{BYTE_ORDER_MARK, Symbols};
use stochc_ir::Cell;
use stochc_planner::{UnreadableVoxels, layers, magica_voxel};

use super::super::programs::verdict;
use super::{PlanOptions, refused};
use crate::exit::Failure;
use crate::host::Host;
use crate::planning::Goal;

/// The target of these options.
pub fn read(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let target = options.target;
    match kind(target).as_deref() {
        Some("vox") => voxels(options, magica_voxel),
        Some("txt") => voxels(options, |bytes| {
            // In comments it does not matter what cannot be read, and elsewhere it is told of with its line.
            let text = String::from_utf8_lossy(bytes);
            layers(text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&text))
        }),
        _ => program(options, host),
    }
}

/// Whether a file is named as those of voxels are.
pub fn is_of_voxels(target: &str) -> bool {
    matches!(kind(target).as_deref(), Some("vox" | "txt"))
}

/// What the name of a file ends in, in small letters.
fn kind(target: &str) -> Option<String> {
    let kind = Path::new(target).extension()?.to_str()?;
    Some(kind.to_ascii_lowercase())
}

fn voxels(
    options: &PlanOptions<'_>,
    cells: impl Fn(&[u8]) -> Result<Vec<Cell>, UnreadableVoxels>,
) -> Result<Goal, Failure> {
    let target = options.target;
    if options.shape.is_some() {
        return Err(Failure::usage(
            "`--shape` is for programs: a file of voxels is one shape",
        ));
    }
    let bytes = read_file(Path::new(target), VOXELS)
        .map_err(|error| Failure::usage(format!("cannot read `{target}`: {error}")))?;
    let cells = cells(&bytes)
        .map_err(|error| Failure::usage(format!("`{target}` is no target: {error}")))?;
    Ok(Goal::of_cells(&name(target), cells))
}

fn program(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let checked = checked(options)?;
    if checked.has_errors() {
        host.report_findings(&checked);
        let mut codes = checked.diagnostics.iter().map(|it| it.code);
        let is_unbuilt =
            codes.all(|code| code == Code::ShapeMismatch || code.severity() == Severity::Warning);
        return Err(Failure {
            exit: verdict(&checked),
            message: match is_unbuilt {
                true => {
                    "help: `--complete` plans what a program claims and does not build\n".to_owned()
                }
                false if is_named_as_program(options.target) => String::new(),
                false => "help: it is read as a program; files of voxels end in `.txt` or `.vox`\n"
                    .to_owned(),
            },
        });
    }
    Goal::of_program(&checked, options.shape).map_err(|reason| refused(options.target, &reason))
}

/// Whether a file is named as programs are.
fn is_named_as_program(target: &str) -> bool {
    Path::new(target)
        .extension()
        .is_some_and(|kind| kind == "sa")
}

/// The program of these options, right or wrong.
pub fn checked(options: &PlanOptions<'_>) -> Result<Checked, Failure> {
    match not_a_file(options.target) {
        Some(_) if Path::new(options.target).is_dir() => Err(Failure::usage(format!(
            "`{}` is a folder: name the file of a program or of a shape; `--run N` plans the rest of a run in a folder of results",
            options.target
        ))),
        Some(reason) => Err(Failure::usage(reason)),
        None => Ok(crate::check_within(
            options.target,
            &Default::default(),
            options.imports,
        )),
    }
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
