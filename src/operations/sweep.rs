//! Programs at the points of a sweep, and the files that summarize a sweep.
use std::collections::HashMap;
use std::sync::Arc;

use stochc_compiler::{LintLevels, Program};
use stochc_experiments::sweep::{Axis, MAX_POINTS, Sweep, points as combine};
use stochc_experiments::trade::Trade;
use stochc_ir::Executable;
use stochc_report::figures::{Figures, sweep as pictures, trade as trade_picture};
use stochc_results::{Compiled, EnsembleProgram, FurtherFiles, MAX_RUNS, Manifest, Records};
use stochc_runtime::Model;
use stochc_runtime::rates::Rates;
use stochc_text::visible;

use super::programs::verdict;
use super::rates::{MissingRates, rates_from};
use super::stored_source::StoredSource;
use crate::exit::Failure;
use crate::host::Host;

/// Compiles each program with the parameter values of each point. Reports all points with errors
/// before the first run.
///
/// # Errors
/// If a point has errors, or there are too many points or runs.
pub fn points(
    axes: &[Axis],
    runs: u64,
    programs: &[EnsembleProgram],
    levels: &LintLevels,
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    let mut at_points = Vec::new();
    for program in programs {
        if program.sources.is_empty() {
            return Err(Failure::usage(format!(
                "--vary: `{}` is already compiled; name its source file instead",
                program.name
            )));
        }
        let points =
            combine(axes, program).map_err(|reason| Failure::usage(format!("--vary: {reason}")))?;
        for point in points {
            let mut entry = program.clone();
            (entry.varied, entry.chosen) = (point.varied, point.chosen);
            entry.name = entry.assembly().to_owned() + &entry.point();
            at_points.push(entry);
        }
    }
    let count = at_points.len();
    if count > MAX_POINTS {
        return Err(Failure::usage(format!(
            "--vary: these are {count} points of {} programs, and {MAX_POINTS} is the most; ask for fewer \
             values",
            programs.len()
        )));
    }
    if runs.saturating_mul(count as u64) > MAX_RUNS {
        return Err(Failure::usage(format!(
            "--vary: {runs} runs at each of {count} points are more than {MAX_RUNS}; lower `--runs`"
        )));
    }
    let mut wrong = Vec::new();
    for entry in &mut at_points {
        if let Err(failure) = at_point(entry, levels, host) {
            wrong.push((entry.name.clone(), failure));
        }
    }
    share_tables(&mut at_points);
    let mut wrong = wrong.into_iter();
    let Some((_, mut failure)) = wrong.next() else {
        return Ok(at_points);
    };
    // Report one error in full, because most points fail for the same reason.
    let more: Vec<String> = wrong.map(|(name, _)| visible(&name)).collect();
    if !more.is_empty() {
        failure.message += &format!("error: nor can these be run: {}\n", more.join(", "));
    }
    Err(failure)
}

/// Returns whether an axis of a sweep varies a setting.
pub fn varies_settings(axes: &[Axis]) -> bool {
    axes.iter().any(|axis| axis.settings().is_some())
}

/// Checks the settings of all points. Adds the rates that the points need, from `known` or from
/// `missing`.
///
/// # Errors
/// If a model does not use a varied setting, or a calibration fails.
pub fn complete(
    manifest: &mut Manifest,
    known: &[Rates],
    missing: MissingRates,
    host: &dyn Host,
) -> Result<(), Failure> {
    for program in &manifest.programs {
        let settings = manifest.settings_of(program);
        if settings.model.unused(settings.chosen()).is_some() {
            return Err(Failure::usage(format!(
                "--vary: `{}`: the model `{}` does not use all of these settings",
                visible(&program.name),
                settings.model.name()
            )));
        }
    }
    let is_by_rates =
        |program: &&EnsembleProgram| manifest.settings_of(program).model == Model::Rate;
    let programs = manifest.programs.iter().filter(is_by_rates);
    let programs: Vec<EnsembleProgram> = programs.cloned().collect();
    manifest.settings.rates = rates_from(missing, known, &programs, host)?;
    Ok(())
}

/// Compiles a program with the parameter values of its point. Does not repeat warnings that the
/// program also has with the values in its source.
///
/// # Errors
/// If the program cannot run at this point.
pub(crate) fn at_point(
    entry: &mut EnsembleProgram,
    levels: &LintLevels,
    host: &dyn Host,
) -> Result<(), Failure> {
    let text = StoredSource::new(entry, levels);
    if text.checked.has_errors() {
        let name = visible(&entry.name);
        let drawn = host.draw(&text.checked);
        return Err(Failure {
            exit: verdict(&text.checked),
            message: format!("error: `{name}` cannot be run:\n{drawn}"),
        });
    }
    let program = text.into_program();
    if let Some(program) = &program {
        entry.parameters = program.plan.parameters.iter().cloned().collect();
    }
    let Some(Executable {
        tables,
        scene,
        graph,
        jam_risks,
    }) = program.and_then(Program::into_executable)
    else {
        return Err(Failure::usage(format!("`{}` does not compile", entry.name)));
    };
    entry.scene = scene;
    entry.compiled = Arc::new(Compiled::new(tables, graph, jam_risks));
    Ok(())
}

/// Stores equal tables of several points only once, to save memory.
pub(crate) fn share_tables(programs: &mut [EnsembleProgram]) {
    let mut known: HashMap<String, Arc<Compiled>> = HashMap::new();
    for program in programs {
        let digest = program.compiled.digest().to_owned();
        let first = known
            .entry(digest)
            .or_insert_with(|| program.compiled.clone());
        let (known, new) = (&first, &program.compiled);
        if known.graph == new.graph && known.jam_risks == new.jam_risks {
            program.compiled = first.clone();
        }
    }
}

/// Returns the files that a sweep adds to a results folder: `sweep.json`, `sweep.csv` and figures.
/// If the sweep varies settings, it also adds `trade.json` and its figure.
///
/// # Errors
/// If the records cannot be read, or a figure cannot be drawn.
pub fn files(manifest: &Manifest, finished: &Records, figures: &Figures) -> FurtherFiles {
    let Some(sweep) = Sweep::from_records(manifest, finished)? else {
        return Ok(Vec::new());
    };
    let mut files = vec![
        (
            "sweep.json".to_owned(),
            sweep.to_json(manifest).into_bytes(),
        ),
        ("sweep.csv".to_owned(), sweep.to_csv().into_bytes()),
    ];
    // Scattered points, such as those of an optimization, have no curves.
    if sweep.is_grid() {
        for drawing in pictures(figures.medium, &sweep, "sweep") {
            files.extend(figures.files(&drawing)?);
        }
    }
    if let Some(trade) = Trade::from_runs(manifest, finished)? {
        files.push((
            "trade.json".to_owned(),
            trade.to_json(manifest).into_bytes(),
        ));
        files.extend(figures.files(&trade_picture(figures.medium, &trade))?);
    }
    Ok(files)
}

/// Returns the same files as [`files`], with figures for screens.
///
/// # Errors
/// See [`files`].
pub fn files_for_screens(manifest: &Manifest, finished: &Records) -> FurtherFiles {
    files(manifest, finished, &Figures::default())
}
