//! Files or a manifest to programs that are ready to run.
use std::path::Path;

use stochc_ensemble::{Manifest, check_manifest, survey, this_build};
use stochc_files::budget::MANIFEST;
use stochc_files::read_file;
use stochc_ir::visible;
use stochc_runtime::rates::Rates;
use stochc_runtime::{Model, Setting, Settings, Substeps};

use super::SimulateArguments;
use super::arguments::{MAX_UNTIL, RUNS};
use crate::exit::Failure;
use crate::host::Host;
use crate::operations::programs::programs;
use crate::operations::runs::warn_of_build;
use crate::operations::{rates, sweep};

/// The manifest of what is asked for.
pub fn prepare(options: &SimulateArguments, host: &dyn Host) -> Result<Manifest, Failure> {
    let mut manifest = match (&options.manifest, &options.out) {
        (Some(path), _) => from_manifest(path, host)?,
        (None, Some(out)) if options.files.is_empty() => from_folder(out)?,
        _ => from_files(options, host)?,
    };
    let most = options.runs.or(options.until.map(|_| MAX_UNTIL));
    manifest.runs = most.unwrap_or(manifest.runs);
    manifest.within_limits().map_err(Failure::usage)?;
    Ok(manifest)
}

/// How runs are computed, but for rates.
fn settings(options: &SimulateArguments) -> Settings {
    Settings {
        model: options.model,
        solver_iterations: options.solver_iterations,
        precision: options.precision,
        reduction: options.reduce,
        max_ticks: Some(options.max_ticks),
        ..Settings::default().with_steps(options.substeps.unwrap_or(Substeps::DEFAULT))
    }
}

/// Refuses settings that the model has no use for.
fn are_used(options: &SimulateArguments, settings: &Settings) -> Result<(), Failure> {
    let model = settings.model;
    // The usual number may be said as well.
    let steps = options.substeps.map(|_| Setting::Steps);
    let rates = (!options.rates.is_empty()).then_some(Setting::Rates);
    let given = steps.into_iter().chain(settings.chosen()).chain(rates);
    let has_no = |option| Err(format!("no `--{option}`; `--model rigid` has it"));
    let used = match model.unused(given) {
        None => Ok(()),
        Some(Setting::Steps) => has_no("substeps"),
        Some(Setting::SolverIterations) => has_no("solver-iterations"),
        Some(Setting::Precision) => has_no("precision"),
        Some(Setting::Reduction) => has_no("reduce"),
        Some(Setting::Rates) => Err("no use for `--rates`; they are for `--model rate`".to_owned()),
    };
    used.map_err(|what| Failure::usage(format!("the model `{}` has {what}", model.name())))
}

/// The rates of the ensemble that is to be gone on with, unless others are given. What is wrong with its folder is told when that is opened.
fn stored_rates(options: &SimulateArguments) -> Option<Vec<Rates>> {
    let goes_on = options.resume && options.rates.is_empty();
    let out = options.out.as_ref().filter(|_| goes_on)?;
    let stored = survey(out).ok().flatten()?;
    stored.uses(Model::Rate).then_some(stored.settings.rates)
}

fn from_files(options: &SimulateArguments, host: &dyn Host) -> Result<Manifest, Failure> {
    let settings = settings(options);
    let varies_settings = sweep::varies_settings(&options.sweep);
    if !varies_settings {
        are_used(options, &settings)?;
    }
    let levels = &options.levels.levels.clone().for_runs(settings.stepping());
    let runs = options.runs.unwrap_or(RUNS);
    let mut programs = programs(&options.files, levels, &options.imports.folders, host)?;
    if !options.sweep.is_empty() {
        programs = sweep::points(&options.sweep, runs, &programs, levels, host)?;
    }
    let given = rates::of_files_for(&options.rates, programs.iter().map(|it| &it.scene), host)?;
    let known = stored_rates(options).unwrap_or(given);
    if varies_settings {
        let mut manifest = Manifest::new(settings, options.chance.seed, runs, programs);
        sweep::complete(&mut manifest, &known, options.work.threads, host)?;
        return Ok(manifest);
    }
    let mut settings = settings.resolved();
    if settings.model == Model::Rate {
        settings.rates = rates::of_scenes(&known, &programs, options.work.threads, host)?;
    }
    Ok(Manifest::new(settings, options.chance.seed, runs, programs))
}

/// The manifest of the ensemble that is gone on with.
fn from_folder(out: &Path) -> Result<Manifest, Failure> {
    let stored = survey(out).map_err(Failure::usage)?;
    let mut manifest = stored.ok_or_else(|| {
        let shown = visible(&out.to_string_lossy());
        Failure::usage(format!(
            "there is nothing to resume in `{shown}`; name the programs as well"
        ))
    })?;
    // What is missing is made by this one.
    manifest.builds = vec![this_build()];
    Ok(manifest)
}

/// The programs that a manifest holds.
fn from_manifest(path: &Path, host: &dyn Host) -> Result<Manifest, Failure> {
    let shown = path.display();
    let bytes = read_file(path, MANIFEST)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    check_manifest(path).map_err(Failure::usage)?;
    let text = String::from_utf8_lossy(&bytes);
    let refuse = |reason: String| Failure::usage(format!("`{shown}`: {reason}"));
    let mut manifest = Manifest::from_json(&text).map_err(refuse)?;
    manifest.within_limits().map_err(refuse)?;
    warn_of_build(&manifest.builds, host);
    // Its runs are made by this one now.
    manifest.builds = vec![this_build()];
    Ok(manifest)
}
