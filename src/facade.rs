//! Functions that check, compile and simulate programs from Rust.
use std::fmt;
use std::ops::ControlFlow;

use stochc_compiler::{Changes, Checked, Limits, LintLevels, Program, check_changed};
use stochc_ir::Executable;
use stochc_ir::record::RunRecord;
use stochc_runtime::{RunError, Settings};

use crate::diagnostics::{Format, show};
use crate::reader::DiskReader;
use crate::source_settings::SourceSettings;

/// Checks a file and its imports, and compiles its assemblies.
///
/// Always returns a result: a file that cannot be read gives a diagnostic.
pub fn check(path: &str) -> Checked {
    check_with(path, &LintLevels::default())
}

/// Checks a file like [`check`]. `levels` apply to warnings whose level the source does not set.
///
/// Small programs are also executed [in every order of events](stochc_compiler::model_check).
pub fn check_with(path: &str, levels: &LintLevels) -> Checked {
    let levels = levels.clone();
    check_source(
        path,
        &SourceSettings {
            levels,
            ..SourceSettings::default()
        },
    )
}

/// Checks a file like [`check_with`]. Ignores values that no assembly of the
/// file uses. Rejects symbolic links that lead out of the folders of imports.
pub fn check_source(path: &str, settings: &SourceSettings) -> Checked {
    let mut reader = DiskReader::new(path, None, &settings.imports);
    let mut checked = check_read(path, &mut reader, settings);
    stochc_compiler::model_check::try_out(&mut checked);
    checked
}

/// Checks a file that `reader` reads.
pub(crate) fn check_read(
    path: &str,
    reader: &mut DiskReader,
    settings: &SourceSettings,
) -> Checked {
    let values = settings.changes();
    let changes = Changes::everywhere(&values);
    check_changed(path, reader, Limits::default(), &settings.levels, changes)
}

/// Error of compiling a file whose check found errors.
#[derive(Debug)]
pub struct CompileError {
    /// Diagnostics of the file, and its sources.
    pub checked: Checked,
}

impl fmt::Display for CompileError {
    /// Writes the diagnostics, one per line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(show(&self.checked, Format::Short, false, 0).trim_end())
    }
}

impl std::error::Error for CompileError {}

/// Returns the programs of a checked file, ready to run.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = "assembly pair { seed plate 1 x 1 { M at (0, 0) }\nphase grow { M.up -> A } }";
/// let programs = stochc::compile(stochc::check_text("pair.sa", text))?;
/// assert_eq!(programs[0].tables.assembly, "pair");
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// If the file has errors.
pub fn compile(checked: Checked) -> Result<Vec<Executable>, Box<CompileError>> {
    if checked.has_errors() {
        return Err(Box::new(CompileError { checked }));
    }
    let programs = checked.programs.into_iter();
    Ok(programs.filter_map(Program::into_executable).collect())
}

/// Simulates one run of a program. The result depends only on the arguments.
///
/// ```
/// use stochc::runtime::{Model, Settings};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let text = "assembly pair { seed plate 1 x 1 { M at (0, 0) }\nphase grow { M.up -> A } }";
/// let programs = stochc::compile(stochc::check_text("pair.sa", text))?;
/// let settings = Settings::new(Model::Shuffle, /* substeps */ 1);
/// let record = stochc::simulate(&programs[0], &settings, /* seed */ 1, /* run */ 0)?;
/// assert_eq!(record.bonds.len(), 1);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// If the settings are invalid for the scene.
pub fn simulate(
    executable: &Executable,
    settings: &Settings,
    seed: u64,
    run: u64,
) -> Result<RunRecord, RunError> {
    let (tables, scene) = (&executable.tables, &executable.scene);
    let mut watch = |_, _| ControlFlow::Continue(());
    stochc_runtime::run(tables, scene, settings, seed, run, &mut watch)
}
