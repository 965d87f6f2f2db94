//! `stochc simulate`.
mod accuracy;
mod completion_curves;
mod input;
mod older_manifest;
mod options;
mod rates;
mod record;
mod single;
mod sweep;

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::table::{Action, Tables};
use stochc_ir::visible;
use stochc_runtime::{RunError, Settings, run as run_once};

pub(super) use input::programs;
pub use options::Options;
pub(super) use rates::of_scenes as rates_of_scenes;
pub(super) use record::begin;
pub(super) use sweep::{at_point, files as sweep_files, share_tables};

use super::interrupt::stop_on_interrupt;
use super::progress::{Display, of_ensemble};
use super::results::{Shown, show, tell_of_damage};
use super::scene_warnings::{SceneWarning, scene_warnings};
use super::terminal::{print, warn};
use super::trade::threads;
use crate::exit::{Exit, Failure};
use stochc_ensemble::Cancelled;
use stochc_ensemble::Checkpoints;
use stochc_ensemble::Destination;
use stochc_ensemble::Folder;
use stochc_ensemble::Manifest;
use stochc_ensemble::Program;
use stochc_ensemble::Progress;
use stochc_ensemble::Resume;
use stochc_ensemble::State;
use stochc_ensemble::Watch;
use stochc_ensemble::check_stored;
use stochc_ensemble::other_build;
use stochc_ensemble::run as run_all;
use stochc_ensemble::shards::{Prepared, prepare};
use stochc_files::shell::file as shell_file;
use stochc_ir::record::RunRecord;

/// Runs programs many times, or one of their runs alone.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let stop = stop_on_interrupt()?;
    let mut manifest = input::prepare(options, stop)?;
    if let Some(run) = (options.record.as_ref()).and_then(|runs| runs.beyond(manifest.runs)) {
        return Err(Failure::usage(format!(
            "--record: {}",
            manifest.no_such_run(run)
        )));
    }
    if let Some(accuracy) = options.accuracy {
        accuracy::settle(options, accuracy, &mut manifest, stop)?;
    }
    // Also about a setting that was found.
    accuracy::comment(options, &manifest)?;
    if options.record.is_some() && !manifest.settings.model.has_places() {
        return Err(Failure::usage(format!(
            "nothing to record: {}",
            RunError::Nowhere(manifest.settings.model)
        )));
    }
    for program in &manifest.programs {
        try_out(program, &manifest.settings)
            .map_err(|error| Failure::wrong_program(format!("{}: {error}", program.name)))?;
    }
    tell_of_doubts(&manifest);
    match (options.run, options.shards.zip(options.out.as_ref())) {
        (Some(number), _) => single::run(options, &manifest, number, stop),
        (None, Some((shards, out))) => cut(options, &manifest, shards, out),
        (None, None) => ensemble(options, &manifest, stop),
    }
}

/// Prepares the pieces of an ensemble.
fn cut(options: &Options, manifest: &Manifest, shards: u64, out: &Path) -> Result<Exit, Failure> {
    let prepared = prepare(out, manifest, shards).map_err(Failure::usage)?;
    if options.quiet {
        return Ok(Exit::Success);
    }
    let folder = shell_file(&visible(&out.to_string_lossy()));
    let already = match prepared {
        Prepared::New => "",
        Prepared::Already => " already",
    };
    let (runs, last) = (manifest.total(), shards - 1);
    print(&format!(
        "`{}` is cut into {shards} pieces{already}, of {runs} runs in all\n\
         To make each, anywhere, in any order: stochc shard {folder} I, for I from 0 to {last}\n\
         To put them together: stochc merge {folder}\n",
        visible(&out.to_string_lossy()),
    ))?;
    Ok(Exit::Success)
}

/// Makes runs of an ensemble, as [`run_all`] asks for them.
pub(super) fn made_by(
    manifest: &Manifest,
) -> impl Fn(usize, u64, &Watch) -> Result<RunRecord, Cancelled> + Sync {
    |program, number, mut watch| made(manifest, (program, number), &mut watch)
}

/// Makes a run of an ensemble again, unless it is stopped.
pub(super) fn made_again(
    manifest: &Manifest,
    stop: &AtomicBool,
) -> impl FnOnce(usize, u64) -> Result<RunRecord, Cancelled> {
    |program, number| {
        let mut watch = |_, _| match stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        made(manifest, (program, number), &mut watch)
    }
}

fn made(
    manifest: &Manifest,
    (program, number): (usize, u64),
    watch: &mut impl stochc_runtime::Watch,
) -> Result<RunRecord, Cancelled> {
    let of = &manifest.programs[program];
    let (settings, seed) = (&manifest.settings, manifest.seed);
    // The scene has been tried out, so only a cancelled run leaves no record.
    run_once(of.tables(), &of.scene, settings, seed, number, watch).map_err(|_| Cancelled)
}

/// Sets a scene up once, so that one that cannot be is told of before the first run.
pub(super) fn try_out(program: &Program, settings: &Settings) -> Result<(), RunError> {
    let mut stop = |_, _| std::ops::ControlFlow::Break(());
    match run_once(program.tables(), &program.scene, settings, 0, 0, &mut stop) {
        Err(RunError::Scene(error)) => Err(error.into()),
        _ => Ok(()),
    }
}

/// Says that runs are added to those of another build, or made again, if they are.
pub(super) fn tell_of_build(builds: &[String]) {
    if let Some(told) = other_build(builds) {
        warn(&format!("warning: {told}\n"));
    }
}

/// Whether a program captures blocks above others, where none that lies on the floor comes.
fn grows_upwards(tables: &Tables) -> bool {
    let mut rules = tables.duties().flat_map(|duty| duty.rules());
    rules.any(|rule| matches!(rule.then, Action::Magnetize { cell, .. } if cell.z > 1))
}

/// Says what the steps of a model do not resolve in the scenes of programs, and what their blocks do not
/// reach: each doubt once, with how many other programs share it.
fn tell_of_doubts(manifest: &Manifest) {
    if !manifest.settings.model.has_places() {
        return;
    }
    let mut found: Vec<(&str, SceneWarning, usize)> = Vec::new();
    for program in &manifest.programs {
        let steps = manifest.settings.steps_in(&program.scene);
        let all = scene_warnings(&program.scene, steps).into_iter();
        for doubt in all.filter(|doubt| !doubt.is_of_height || grows_upwards(program.tables())) {
            match found
                .iter_mut()
                .find(|(_, it, _)| it.symbol == doubt.symbol)
            {
                Some((_, _, more)) => *more += 1,
                None => found.push((&program.name, doubt, 0)),
            }
        }
    }
    for (name, SceneWarning { figure, effect, .. }, more) in found {
        let others = match more {
            0 => String::new(),
            1 => " and another program".to_owned(),
            more => format!(" and {more} other programs"),
        };
        warn(&format!(
            "warning: {name}{others}: {figure}: {effect}; `stochc check --scene` shows more\n"
        ));
    }
}

/// Says what has become of checkpoints.
pub(super) fn tell_of_checkpoints(checkpoints: Option<&Checkpoints>) {
    for note in checkpoints.map(Checkpoints::notes).unwrap_or_default() {
        warn(&format!("note: {note}\n"));
    }
}

fn ensemble(options: &Options, manifest: &Manifest, stop: &AtomicBool) -> Result<Exit, Failure> {
    let mut checkpoints = None;
    let destination = match &options.out {
        None => Destination::Memory(manifest),
        Some(out) => {
            let resume = match (options.resume, options.mixed_builds) {
                (_, true) => Resume::MixedBuilds,
                (resume, false) => resume.into(),
            };
            let folder = Folder::open(out, manifest, resume).map_err(Failure::usage)?;
            tell_of_damage(out, folder.damage());
            match folder.state() {
                State::New => {}
                State::Finished => warn(&format!(
                    "`{}` is finished already\n",
                    visible(&out.to_string_lossy())
                )),
                // Of a manifest that is given it has been told.
                State::Resumed if options.manifest.is_some() => {}
                State::Resumed => tell_of_build(folder.builds()),
            }
            if folder.state() == State::Resumed {
                check_stored(&folder, made_again(manifest, stop)).map_err(Failure::usage)?;
            }
            let folder = folder.with_checkpoints(options.checkpoints);
            let folder = folder.map_err(Failure::usage)?;
            checkpoints = folder.checkpoints().cloned();
            tell_of_checkpoints(checkpoints.as_deref());
            Destination::Folder(folder.with(sweep::files))
        }
    };
    let progress = Progress::new(manifest, threads(options.threads));
    let recordings = record::Recordings::new(options, manifest);
    let unrecorded = made_by(manifest);
    let simulate = |program: usize, number, mut watch: &Watch| match recordings.of(program, number)
    {
        Some(place) => {
            let record = place.record(&manifest.programs[program], &mut watch);
            record.map_err(|_| Cancelled)
        }
        None => unrecorded(program, number, watch),
    };
    let display = match manifest.total() {
        // There is nothing to wait for.
        total if destination.kept() == total => Display::Quiet,
        _ => Display::on_standard_error(options.quiet),
    };
    let state = |elapsed| of_ensemble(manifest, &progress, elapsed);
    let results = display
        .during(state, || run_all(destination, &progress, stop, simulate))
        .map_err(Failure::usage)?;
    tell_of_checkpoints(checkpoints.as_deref());
    let unrecorded = recordings.comment(&results.finished);
    let shown = Shown {
        form: options.format,
        bonds: options.bonds,
    };
    let exit = show(manifest, &results.finished, &shown)?;
    completion_curves::close(options, manifest, &results.finished)?;
    if results.complete {
        return unrecorded.map_or(Ok(exit), Err);
    }
    let message = match &options.out {
        Some(_) => "stopped; finished runs are kept, and `--resume` continues\n",
        None => "stopped; with `--out DIR`, finished runs are kept\n",
    };
    Err(Failure {
        exit: Exit::Interrupted,
        message: message.to_owned(),
    })
}
