//! Sources of an ensemble: programs, a manifest or a results folder.
use std::path::Path;

use stochc_experiments::sweep::Axis;
use stochc_files::budget::MANIFEST as MAX_MANIFEST;
use stochc_files::read_file;
use stochc_results::{MANIFEST, Manifest, ManifestError, check_manifest, survey, this_build};
use stochc_runtime::Model;
use stochc_text::visible;

use super::arguments::ProgramOptions;
use crate::exit::Failure;
use crate::host::Host;
use crate::operations::programs::programs;
use crate::operations::rates::{MissingRates, rates_from, read_rates_for};
use crate::operations::runs::warn_of_build;
use crate::operations::sweep;

/// Returns the manifest of an ensemble of programs, at all points of a sweep over `axes`.
pub fn from_programs(
    options: &ProgramOptions,
    axes: &[Axis],
    runs: u64,
    missing: MissingRates,
    host: &dyn Host,
) -> Result<Manifest, Failure> {
    let settings = options.model.settings();
    let given_twice = axes.iter().find(|axis| options.model.gives(&axis.name));
    if let Some(Axis { name, .. }) = given_twice {
        return Err(Failure::usage(format!(
            "`--{name}` and `--vary {name}=...` exclude each other; leave one of them out"
        )));
    }
    let varies_settings = sweep::varies_settings(axes);
    if !varies_settings {
        options.model.are_used(&settings)?;
    }
    let mut source = options.source.settings();
    source.levels = source.levels.for_runs(settings.stepping());
    let mut programs = programs(&options.files, &source, host)?;
    if !axes.is_empty() {
        programs = sweep::points(axes, runs, &programs, &source.levels, host)?;
    }
    let scenes = programs.iter().map(|it| &it.scene);
    let known = read_rates_for(&options.model.rates, scenes, host)?;
    let manifest = if varies_settings {
        let mut manifest = Manifest::new(settings, options.chance.seed, runs, programs);
        sweep::complete(&mut manifest, &known, missing, host)?;
        manifest
    } else {
        let mut settings = settings.resolved();
        if settings.model == Model::Rate {
            settings.rates = rates_from(missing, &known, &programs, host)?;
        }
        Manifest::new(settings, options.chance.seed, runs, programs)
    };
    manifest.within_limits().map_err(Failure::usage)?;
    Ok(manifest)
}

/// Returns the manifest of a results folder whose runs are to be resumed. `runs` replaces the
/// number of runs.
pub fn from_folder(folder: &Path, runs: Option<u64>) -> Result<Manifest, Failure> {
    let stored = survey(folder).map_err(Failure::usage)?;
    let manifest = stored.ok_or_else(|| {
        let shown = visible(&folder.to_string_lossy());
        Failure::usage(format!(
            "there is nothing to resume in `{shown}`; `stochc simulate` and `stochc sweep` begin an ensemble"
        ))
    })?;
    by_this_build(manifest, runs)
}

/// Returns the manifest in a file or a results folder. `runs` replaces the number of runs.
pub fn from_manifest(path: &Path, runs: Option<u64>, host: &dyn Host) -> Result<Manifest, Failure> {
    let in_folder = path.join(MANIFEST);
    let path = if path.is_dir() { &in_folder } else { path };
    let shown = path.display();
    let bytes = read_file(path, MAX_MANIFEST)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    check_manifest(path).map_err(Failure::usage)?;
    let text = String::from_utf8_lossy(&bytes);
    let refuse = |reason: ManifestError| Failure::usage(format!("`{shown}`: {reason}"));
    let manifest = Manifest::from_json(&text).map_err(refuse)?;
    manifest.within_limits().map_err(refuse)?;
    let builds = manifest.builds.clone();
    let manifest = by_this_build(manifest, runs)?;
    warn_of_build(&builds, host);
    Ok(manifest)
}

/// Returns the manifest with only this build in its list of builds. `runs` replaces the number of
/// runs.
fn by_this_build(mut manifest: Manifest, runs: Option<u64>) -> Result<Manifest, Failure> {
    if manifest.uses(Model::Measured) {
        return Err(Failure::usage(
            "these runs were measured in an experiment, so they cannot be simulated; `stochc import` reads another log into a new folder",
        ));
    }
    manifest.runs = runs.unwrap_or(manifest.runs);
    manifest.builds = vec![this_build()];
    manifest.within_limits().map_err(Failure::usage)?;
    Ok(manifest)
}
