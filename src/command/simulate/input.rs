//! Files or a manifest to programs that are ready to run.

use std::sync::atomic::AtomicBool;

use stochc_compiler::{Checked, LintLevels};
use stochc_ensemble::{Manifest, OLDEST, Program, Source, Varied, this_build};
use stochc_files::budget::MANIFEST;
use stochc_files::programs::{executables, refusal};
use stochc_files::read_file;
use stochc_ir::Executable;
use stochc_ir::scene::scalars::Change;
use stochc_runtime::{Model, Settings};

use super::super::check::verdict;
use super::super::imports::ImportOptions;
use super::super::terminal::{has_colour, message_width, told, warn_drawn};
use super::{Options, older_manifest, rates, sweep, tell_of_build};
use crate::diagnostics::drawn;
use crate::exit::Failure;

/// The manifest of what is asked for.
pub fn prepare(options: &Options, stop: &AtomicBool) -> Result<Manifest, Failure> {
    match &options.manifest {
        Some(path) => from_manifest(path, &options.levels.levels),
        None => from_files(options, stop),
    }
}

/// The programs of files, if nothing is wrong in any of them.
pub fn programs(
    files: &[String],
    levels: &LintLevels,
    imports: &ImportOptions,
) -> Result<Vec<Program>, Failure> {
    let mut programs = Vec::new();
    let mut wrong = None;
    for file in files {
        match read(file, levels, imports) {
            Ok(found) => programs.extend(found),
            Err(failure) => wrong = Some(Failure::silent(told(Err(failure)))),
        }
    }
    wrong.map_or(Ok(programs), Err)
}

fn read(file: &str, levels: &LintLevels, imports: &ImportOptions) -> Result<Vec<Program>, Failure> {
    if let Some(reason) = refusal(file) {
        return Err(Failure::usage(reason));
    }
    match executables(file) {
        Some(Ok(found)) => Ok(compiled(found)),
        Some(Err(reason)) => Err(Failure::usage(format!("`{file}`: {reason}"))),
        None => accept(file, crate::check_within(file, levels, &imports.folders)),
    }
}

fn from_files(options: &Options, stop: &AtomicBool) -> Result<Manifest, Failure> {
    let mut programs = programs(&options.files, &options.levels.levels, &options.imports)?;
    if !options.sweep.is_empty() {
        programs = sweep::points(options, &programs)?;
    }
    let settings = Settings {
        model: options.model.into(),
        solver_iterations: options.solver_iterations,
        precision: options.precision.into(),
        reduction: options.reduce.map(Into::into),
        max_ticks: Some(options.max_ticks),
        ..Settings::default().with_steps(options.substeps)
    };
    let mut settings = settings.resolved();
    if settings.model == Model::Rate {
        settings.rates = rates::of_scenes(
            &options.rates,
            &programs,
            (options.threads, options.quiet),
            stop,
        )?;
    }
    let manifest = Manifest::new(settings, options.seed, options.runs, programs);
    manifest.within_limits().map_err(Failure::usage)?;
    Ok(manifest)
}

/// Programs that were compiled elsewhere.
fn compiled(executables: Vec<Executable>) -> Vec<Program> {
    let programs = executables.into_iter().map(|executable| {
        let name = executable.tables.assembly.clone();
        Program::new(&name, Vec::new(), executable)
    });
    programs.collect()
}

/// The programs of a file in which nothing is wrong.
pub(super) fn accept(file: &str, checked: Checked) -> Result<Vec<Program>, Failure> {
    warn_drawn(&drawn(&checked, has_colour(), message_width()));
    if checked.has_errors() {
        return Err(Failure::silent(verdict(&checked)));
    }
    if checked.programs.is_empty() {
        return Err(Failure::usage(format!(
            "`{file}` declares no assembly or aggregate to run"
        )));
    }
    let sources: Vec<Source> = (checked.sources.files().iter())
        .map(|file| Source {
            path: file.name.clone(),
            text: file.text.to_string(),
        })
        .collect();
    let complete = checked.programs.into_iter().filter_map(|program| {
        let executable = program.into_executable()?;
        let name = executable.tables.assembly.clone();
        Some(Program::new(&name, sources.clone(), executable))
    });
    Ok(complete.collect())
}

/// Compiles texts that were kept, for the assembly of a name, with the numbers that are varied.
pub(super) fn recompile(
    sources: &[Source],
    varied: &[Varied],
    assembly: &str,
    levels: &LintLevels,
) -> Checked {
    let texts = sources.iter();
    let texts: Vec<_> = texts
        .map(|it| (it.path.as_str(), it.text.as_str()))
        .collect();
    let changes = varied.iter().map(|varied| Change {
        of: varied.of.clone(),
        value: varied.value,
    });
    crate::check_texts(&texts, levels, assembly, &changes.collect::<Vec<_>>())
}

/// The programs that a manifest holds.
fn from_manifest(path: &std::path::Path, levels: &LintLevels) -> Result<Manifest, Failure> {
    let shown = path.display();
    let bytes = read_file(path, MANIFEST)
        .map_err(|error| Failure::usage(format!("cannot read `{shown}`: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    let refuse = |reason: String| Failure::usage(format!("`{shown}`: {reason}"));
    let mut manifest = match Manifest::format(&text).map_err(refuse)? {
        older @ 1..OLDEST => older_manifest::read(older, &text, path, levels)?,
        _ => Manifest::from_json(&text).map_err(refuse)?,
    };
    manifest.within_limits().map_err(refuse)?;
    tell_of_build(&manifest.builds);
    // Its runs are made by this one now.
    manifest.builds = vec![this_build()];
    Ok(manifest)
}
