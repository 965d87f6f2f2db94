//! Files or a manifest to programs that are ready to run.
use stochc_compiler::LintLevels;
use stochc_ensemble::{Manifest, OLDEST, this_build};
use stochc_files::budget::MANIFEST;
use stochc_files::read_file;
use stochc_runtime::{Model, Settings};

use super::{SimulateArguments, older_manifest};
use crate::exit::Failure;
use crate::host::Host;
use crate::operations::programs::programs;
use crate::operations::runs::warn_of_build;
use crate::operations::{rates, sweep};

/// The manifest of what is asked for.
pub fn prepare(options: &SimulateArguments, host: &dyn Host) -> Result<Manifest, Failure> {
    match &options.manifest {
        Some(path) => from_manifest(path, &options.levels.levels, host),
        None => from_files(options, host),
    }
}

fn from_files(options: &SimulateArguments, host: &dyn Host) -> Result<Manifest, Failure> {
    let levels = &options.levels.levels;
    let mut programs = programs(&options.files, levels, &options.imports.folders, host)?;
    if !options.sweep.is_empty() {
        programs = sweep::points(&options.sweep, options.runs, &programs, levels, host)?;
    }
    let settings = Settings {
        model: options.model,
        solver_iterations: options.solver_iterations,
        precision: options.precision,
        reduction: options.reduce,
        max_ticks: Some(options.max_ticks),
        ..Settings::default().with_steps(options.substeps)
    };
    let mut settings = settings.resolved();
    if settings.model == Model::Rate {
        settings.rates = rates::of_scenes(&options.rates, &programs, options.work.threads, host)?;
    }
    let manifest = Manifest::new(settings, options.chance.seed, options.runs, programs);
    manifest.within_limits().map_err(Failure::usage)?;
    Ok(manifest)
}

/// The programs that a manifest holds.
fn from_manifest(
    path: &std::path::Path,
    levels: &LintLevels,
    host: &dyn Host,
) -> Result<Manifest, Failure> {
    let shown = path.display();
    let bytes = read_file(path, MANIFEST)
        .map_err(|error| Failure::usage(format!("cannot read `{shown}`: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    let refuse = |reason: String| Failure::usage(format!("`{shown}`: {reason}"));
    let mut manifest = match Manifest::format(&text).map_err(refuse)? {
        older @ 1..OLDEST => older_manifest::read(older, &text, path, levels, host)?,
        _ => Manifest::from_json(&text).map_err(refuse)?,
    };
    manifest.within_limits().map_err(refuse)?;
    warn_of_build(&manifest.builds, host);
    // Its runs are made by this one now.
    manifest.builds = vec![this_build()];
    Ok(manifest)
}
