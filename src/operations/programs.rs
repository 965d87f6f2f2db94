//! Programs that are ready to run, read from files.
use std::fmt::Display;
use std::path::Path;

use stochc_compiler::{Changes, Checked, LintLevels};
use stochc_files::programs::{executables, not_a_file, programs as in_folders};
use stochc_grammar::tree::ItemKind;
use stochc_ir::Executable;
use stochc_results::{EnsembleProgram, Source, Varied};

use crate::exit::{Exit, Failure};
use crate::host::Host;
use crate::source_settings::{SourceSettings, UnusedValues, change};

/// Reads and compiles the programs of all files.
///
/// # Errors
/// If a file cannot be read, has errors, or contains nothing to run. All files are checked first.
pub fn programs(
    files: &[String],
    settings: &SourceSettings,
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    let files = expanded(files)?;
    let mut wrong = None;
    for failure in files.iter().filter_map(|file| is_readable(file).err()) {
        host.report_failure(&failure.message);
        wrong = Some(Failure::silent(failure.exit));
    }
    if let Some(wrong) = wrong {
        return Err(wrong);
    }
    let mut programs = Vec::new();
    for file in &files {
        match read(file, settings, host) {
            Ok(found) => programs.extend(found),
            Err(failure) => {
                host.report_failure(&failure.message);
                wrong = Some(Failure::silent(failure.exit));
            }
        }
    }
    if let Some(wrong) = wrong {
        return Err(wrong);
    }
    let mut unused = UnusedValues::new(settings);
    for program in &programs {
        let parameters = program.parameters.keys().map(String::as_str);
        unused.remove(parameters, Some(&program.scene));
    }
    unused.check()?;
    Ok(programs)
}

/// Returns the paths of files. Each folder is replaced by the programs in it.
fn expanded(arguments: &[String]) -> Result<Vec<String>, Failure> {
    let files = arguments.iter().flat_map(|argument| {
        if Path::new(argument).is_dir() {
            in_folders(std::slice::from_ref(argument))
        } else {
            vec![Ok(argument.clone())]
        }
    });
    files.map(|file| file.map_err(Failure::usage)).collect()
}

/// Checks that an argument is a readable file.
///
/// # Errors
/// If the file cannot be opened. The error contains the reason.
pub fn is_readable(file: &str) -> Result<(), Failure> {
    if let Some(reason) = not_a_file(file) {
        return Err(Failure::usage(reason));
    }
    let opened = stochc_files::open(Path::new(file));
    opened.map(drop).map_err(|error| cannot_read(file, error))
}

/// Returns the failure for a file that cannot be read.
pub fn cannot_read(file: &str, reason: impl Display) -> Failure {
    Failure::usage(format!("cannot read {file}: {reason}"))
}

fn read(
    file: &str,
    settings: &SourceSettings,
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    match executables(file) {
        Some(Ok(found)) if found.is_empty() => Err(Failure::usage(format!(
            "`{file}` contains no program to run"
        ))),
        Some(Ok(_)) if !settings.set.is_empty() => Err(Failure::usage(format!(
            "--set: `{file}` is already compiled; name its source file instead"
        ))),
        Some(Ok(found)) => Ok(compiled(found)),
        Some(Err(reason)) => Err(Failure::usage(format!("`{file}`: {reason}"))),
        None => accept(file, crate::check_source(file, settings), settings, host),
    }
}

/// Returns executables as programs of an ensemble.
fn compiled(executables: Vec<Executable>) -> Vec<EnsembleProgram> {
    let programs = executables.into_iter().map(|executable| {
        let name = executable.tables.assembly.clone();
        EnsembleProgram::new(&name, Vec::new(), executable)
    });
    programs.collect()
}

/// Returns the programs of a file that was checked with `settings`, and reports its diagnostics.
///
/// # Errors
/// If the file has errors or contains nothing to run, or a parameter cannot have its value.
pub fn accept(
    file: &str,
    checked: Checked,
    settings: &SourceSettings,
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    host.report_diagnostics(&checked);
    if checked.has_errors() {
        return Err(Failure::silent(verdict(&checked)));
    }
    if checked.programs.is_empty() {
        return Err(nothing_to_run(file, &checked));
    }
    let sources: Vec<Source> = (checked.sources.files().iter())
        .map(|file| Source {
            path: file.name.clone(),
            text: file.text.to_string(),
        })
        .collect();
    let mut complete = Vec::new();
    for program in checked.programs {
        let set = settings.used_by(&program)?;
        let parameters = program.plan.parameters.iter().cloned().collect();
        let claims = program.claims.clone();
        let Some(executable) = program.into_executable() else {
            continue;
        };
        let name = executable.tables.assembly.clone();
        let mut program = EnsembleProgram::new(&name, sources.clone(), executable);
        (program.parameters, program.set) = (parameters, set);
        program.claims = claims;
        program.name += &program.point();
        complete.push(program);
    }
    Ok(complete)
}

/// Returns the failure for a file without an assembly.
pub fn nothing_to_run(file: &str, checked: &Checked) -> Failure {
    Failure::usage(format!(
        "`{file}` declares no assembly or aggregate to run{}",
        plan_advice(file, checked)
    ))
}

/// Returns the advice to plan an assembly for the shape of a file. Empty if the file
/// declares no shape.
pub fn plan_advice(file: &str, checked: &Checked) -> String {
    let mut items = checked.tree.items.iter();
    if !items.any(|item| matches!(item.kind, ItemKind::Shape(_))) {
        return String::new();
    }
    let file = stochc_files::shell::file(file);
    format!("; `stochc plan {file}` writes an assembly for its shape")
}

/// Compiles stored sources for one assembly, with other values of its parameters.
pub fn recompile<'a>(
    sources: &[Source],
    values: impl Iterator<Item = &'a Varied>,
    assembly: &str,
    levels: &LintLevels,
) -> Checked {
    let texts = sources.iter();
    let texts: Vec<_> = texts
        .map(|it| (it.path.as_str(), it.text.as_str()))
        .collect();
    let values: Vec<_> = values.map(change).collect();
    crate::check_texts(&texts, levels, Changes::in_assembly(assembly, &values))
}

/// Returns the exit status for a file with these diagnostics.
pub fn verdict(checked: &Checked) -> Exit {
    if !checked.has_errors() {
        Exit::Success
    } else if checked.sources.files().is_empty() {
        Exit::Usage
    } else {
        Exit::InvalidProgram
    }
}
