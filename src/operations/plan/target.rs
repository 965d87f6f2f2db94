//! Reading of a plan's target.
use std::path::{Path, PathBuf};

use stochc_compiler::Checked;
use stochc_compiler::diagnostic::{Code, Severity};
use stochc_files::budget::VOXELS;
use stochc_files::read_file;
use stochc_grammar::{BYTE_ORDER_MARK, Symbols};
use stochc_ir::Cell;
use stochc_planner::{UnreadableVoxels, VoxelScene, layers, magica_voxel};
use stochc_text::{counted, listed, visible};

use super::super::programs::{is_readable, verdict};
use super::PlanOptions;
use super::not_planned::refused;
use crate::SourceSettings;
use crate::exit::Failure;
use crate::host::Host;
use stochc_planner::Goal;

/// Reads the target that the options name.
///
/// # Errors
/// If the target cannot be read or contains no shape.
pub fn read(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let target = options.target;
    let kind = kind(target);
    if options.model.is_some() && kind.as_deref() != Some("vox") {
        return Err(Failure::usage(
            "`--model` is for `.vox` files: others have one model",
        ));
    }
    match kind.as_deref() {
        Some("vox") => voxels(options, |bytes| {
            let VoxelScene { cells, hidden } = magica_voxel(bytes, options.model)?;
            report_hidden(target, &hidden, host);
            Ok(cells)
        }),
        Some("txt") => voxels(options, |bytes| {
            // Invalid characters are harmless in comments. Elsewhere, the parser reports them with
            // their line.
            let text = String::from_utf8_lossy(bytes);
            layers(text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&text))
        }),
        _ => program(options, host),
    }
}

/// Warns about hidden models of a voxel scene, which are not built.
fn report_hidden(target: &str, hidden: &[u32], host: &dyn Host) {
    /// Largest number of models that the message lists.
    const LISTED: usize = 8;
    if !hidden.is_empty() {
        let numbers: Vec<String> = hidden.iter().take(LISTED).map(u32::to_string).collect();
        host.note(&format!(
            "note: left out {} of `{}`: {}\n",
            counted(hidden.len(), "hidden model"),
            visible(target),
            listed(&numbers, hidden.len())
        ));
    }
}

/// Returns whether a file name has the extension of a voxel file.
pub fn is_of_voxels(target: &str) -> bool {
    matches!(kind(target).as_deref(), Some("vox" | "txt"))
}

/// Returns the extension of a file name in lower case. Returns `None` if there is none.
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
        .map_err(|error| Failure::usage(format!("cannot read {target}: {error}")))?;
    let cells = cells(&bytes)
        .map_err(|error| Failure::usage(format!("`{target}` cannot be planned: {error}")))?;
    Ok(Goal::from_cells(&name(target), cells))
}

fn program(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let checked = checked(options)?;
    if checked.has_errors() {
        host.report_diagnostics(&checked);
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
    Goal::from_program(&checked, options.shape).map_err(|error| refused(options.target, error))
}

/// Returns whether a file name has the extension of a program.
pub fn is_named_as_program(target: &str) -> bool {
    Path::new(target)
        .extension()
        .is_some_and(|kind| kind == "sa")
}

/// Compiles the target program. The result may contain errors.
pub fn checked(options: &PlanOptions<'_>) -> Result<Checked, Failure> {
    if Path::new(options.target).is_dir() {
        return Err(Failure::usage(format!(
            "`{}` is a folder: name the file of a program or of a shape; `--run N` plans the rest of a run in a folder of results",
            options.target
        )));
    }
    checked_file(options.target, options.imports)
}

/// Compiles a file. The result may contain errors.
pub fn checked_file(file: &str, imports: &[PathBuf]) -> Result<Checked, Failure> {
    is_readable(file)?;
    let settings = SourceSettings {
        imports: imports.to_vec(),
        ..SourceSettings::default()
    };
    Ok(crate::check_source(file, &settings))
}

pub fn is_name(name: &str) -> bool {
    // Test keywords with the lexer of the language, so that new keywords are included.
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let begins_well = !name.starts_with(|first: char| first.is_ascii_digit());
    !name.is_empty()
        && begins_well
        && name.chars().all(is_word)
        && Symbols::new().get(name).is_none()
}

/// Returns a valid name for the shape in a file, derived from the file name.
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
    if begins_well && is_name(&name) {
        return name;
    }
    format!("shape_{name}")
}
