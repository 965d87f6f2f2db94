//! Files or a manifest to programs that are ready to run.

use stochc_compiler::{Checked, Levels};
use stochc_runtime::{Model, Precision, Reduction, Settings};

use super::super::check::verdict;
use super::super::terminal::{has_colour, message_width, warn};
use super::{Options, Ready, swept, tell_of_build, usage};
use crate::cli::Exit;
use crate::ensemble::{FORMAT, Manifest, Program, Source, this_build};
use crate::files::programs::refusal;
use crate::files::read_file;
use crate::findings::drawn;

/// The setting of a manifest that holds the solver's iterations.
const SOLVER_ITERATIONS: &str = "solver_iterations";
/// The one that holds the digits, where they are not the usual ones.
const PRECISION: &str = "precision";
/// The one that holds what is left out.
const REDUCTION: &str = "reduction";

/// The manifest of what is asked for, and its programs.
pub fn prepare(options: &Options) -> Result<(Manifest, Vec<Ready>), Exit> {
    match &options.manifest {
        Some(path) => from_manifest(path, &options.levels.levels),
        None => from_files(options),
    }
}

/// The programs of files, if nothing is wrong in any of them.
pub fn programs(files: &[String], levels: &Levels) -> Result<(Vec<Program>, Vec<Ready>), Exit> {
    let mut entries = Vec::new();
    let mut ready = Vec::new();
    let mut wrong = None;
    for file in files {
        if let Some(reason) = refusal(file) {
            wrong = Some(usage(&reason));
            continue;
        }
        let checked = crate::check_with(file, levels);
        match accept(file, checked) {
            Ok(programs) => {
                for (entry, program) in programs {
                    entries.push(entry);
                    ready.push(program);
                }
            }
            Err(exit) => wrong = Some(exit),
        }
    }
    wrong.map_or(Ok((entries, ready)), Err)
}

fn from_files(options: &Options) -> Result<(Manifest, Vec<Ready>), Exit> {
    let (mut entries, mut ready) = programs(&options.files, &options.levels.levels)?;
    if !options.sweep.is_empty() {
        (entries, ready) = swept::points(options, &entries)?;
    }
    let settings = Settings {
        model: options.model.into(),
        substeps: options.substeps,
        solver_iterations: options.solver_iterations,
        precision: options.precision.into(),
        reduction: options.reduce.map(Into::into),
        max_ticks: Some(options.max_ticks),
    };
    let mut manifest = Manifest::new(settings.model.name(), options.seed, options.runs, entries);
    write_down(&settings, &mut manifest);
    manifest.max_ticks = settings.max_ticks;
    manifest.within_limits().map_err(|reason| usage(&reason))?;
    Ok((manifest, ready))
}

/// Puts settings into a manifest, but for the limit of ticks; [`settings`] reads them back.
pub fn write_down(settings: &Settings, manifest: &mut Manifest) {
    settings.model.name().clone_into(&mut manifest.model);
    manifest.substeps = settings.substeps;
    manifest.settings.clear();
    let mut set = |name: &str, value: &str| manifest.settings.insert(name.into(), value.into());
    set(SOLVER_ITERATIONS, &settings.iterations().to_string());
    if settings.precision != Precision::default() {
        set(PRECISION, settings.precision.name());
    }
    if let Some(reduction) = settings.reduction {
        set(REDUCTION, reduction.name());
    }
}

/// The programs of a file in which nothing is wrong.
fn accept(file: &str, checked: Checked) -> Result<Vec<(Program, Ready)>, Exit> {
    warn(&drawn(&checked, has_colour(), message_width()));
    if checked.has_errors() {
        return Err(verdict(&checked));
    }
    if checked.programs.is_empty() {
        return Err(usage(&format!(
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
        let (tables, scene) = (program.tables?, program.scene?);
        let entry = Program::new(&tables.assembly, sources.clone(), scene.clone(), &tables);
        Some((entry, Ready { tables, scene }))
    });
    Ok(complete.collect())
}

/// Compiles the sources that a manifest holds, and nothing else.
fn from_manifest(path: &std::path::Path, levels: &Levels) -> Result<(Manifest, Vec<Ready>), Exit> {
    let shown = path.display();
    let bytes =
        read_file(path).map_err(|error| usage(&format!("cannot read `{shown}`: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    let mut manifest =
        Manifest::from_json(&text).map_err(|reason| usage(&format!("`{shown}`: {reason}")))?;
    // The runs of an older folder go into one of the present layout.
    manifest.format = FORMAT;
    tell_of_build(&manifest.builds);
    // They are made by this one now.
    manifest.builds = vec![this_build()];
    let mut ready = Vec::new();
    for entry in &manifest.programs {
        let (root, checked) = entry.recompile(levels);
        let found = accept(root, checked)?
            .into_iter()
            .find(|(_, program)| program.tables.assembly == entry.assembly);
        let same = found.filter(|(_, program)| {
            program.scene == entry.scene && entry.phases.len() == program.tables.phases.len()
        });
        let Some((_, program)) = same else {
            return Err(usage(&format!(
                "`{shown}`: its sources do not give its assembly `{}` any more",
                entry.assembly
            )));
        };
        ready.push(program);
    }
    Ok((manifest, ready))
}

/// The settings of the runtime that a manifest asks for.
pub fn settings(manifest: &Manifest) -> Result<Settings, String> {
    let model = (Model::ALL.into_iter())
        .find(|model| model.name() == manifest.model)
        .ok_or_else(|| format!("this version has no model `{}`", manifest.model))?;
    let set = |name: &str| manifest.settings.get(name);
    let solver_iterations = match set(SOLVER_ITERATIONS) {
        None => None,
        Some(text) => Some(
            (text.parse().ok().filter(|&n: &u32| n > 0))
                .ok_or_else(|| format!("`{SOLVER_ITERATIONS}` is `{text}`, not a number from 1"))?,
        ),
    };
    let precision = match set(PRECISION) {
        None => Precision::default(),
        Some(text) => (Precision::ALL.into_iter())
            .find(|precision| precision.name() == text)
            .ok_or_else(|| format!("this version has no precision `{text}`"))?,
    };
    let reduction = match set(REDUCTION) {
        None => None,
        Some(text) => Some(
            (Reduction::ALL.into_iter())
                .find(|reduction| reduction.name() == text)
                .ok_or_else(|| format!("this version has no reduced model `{text}`"))?,
        ),
    };
    if manifest.substeps == 0 {
        return Err("`substeps` is 0; at least 1 is needed".into());
    }
    Ok(Settings {
        model,
        substeps: manifest.substeps,
        solver_iterations,
        precision,
        reduction,
        max_ticks: manifest.max_ticks,
    })
}
