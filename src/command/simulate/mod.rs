//! `stochc simulate`.
mod arguments;
mod completion_curves;
mod input;
mod single;

use std::path::Path;

use stochc_ir::visible;

pub(super) use arguments::MAX_TICKS;
pub use arguments::SimulateArguments;

use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::show::{ResultsView, show};
use super::terminal::{print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::ensemble::{EnsembleOptions, MadeEnsemble, can_record, judge_scenes, make};
use crate::operations::forecast::{cpu_time, forecast_to_text};
use crate::operations::precision::make_until;
use crate::operations::runs::try_out_all;
use stochc_ensemble::Manifest;
use stochc_ensemble::Resume;
use stochc_ensemble::shards::{Prepared, prepare};
use stochc_files::shell::file as shell_file;
use stochc_report::presentation::Presentation;

/// Runs programs many times, or one of their runs alone.
pub fn run(options: &SimulateArguments) -> Result<Exit, Failure> {
    let host = Terminal::new(options.work.quiet);
    let stop = stop_on_interrupt()?;
    let manifest = input::prepare(options, &host)?;
    let is_sweep = manifest.programs.iter().any(|it| it.is_point());
    if options.figures.are_given() && !is_sweep {
        return Err(Failure::usage(
            "`--figures` and `--figure-format` are for the figures of `--sweep`; `stochc report` draws those of other folders",
        ));
    }
    if let Some(reduction) = manifest.settings.reduction {
        warn(&format!(
            "note: `{}` is a reduced model: it leaves out something that the scene has\n",
            reduction.name()
        ));
    }
    can_record(&manifest, options.record.as_ref())?;
    try_out_all(&manifest)?;
    // A check of the texts has judged the steps that are asked for.
    let is_checked = options.manifest.is_none() && !options.files.is_empty();
    judge_scenes(&manifest, is_checked, &options.levels.levels, &host)?;
    if options.dry_run {
        let forecast = cpu_time(&manifest, &host)?;
        print(&forecast_to_text(&forecast, options.work.threads))?;
        return Ok(Exit::Success);
    }
    match (options.run, options.shards.zip(options.out.as_ref())) {
        (Some(number), _) => single::run(options, &manifest, number, stop),
        (None, Some((shards, out))) => cut(options, &manifest, shards, out),
        (None, None) => ensemble(options, manifest, &host),
    }
}

/// Prepares the pieces of an ensemble.
fn cut(
    options: &SimulateArguments,
    manifest: &Manifest,
    shards: u64,
    out: &Path,
) -> Result<Exit, Failure> {
    let prepared = prepare(out, manifest, shards).map_err(Failure::usage)?;
    if options.work.quiet {
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

fn ensemble(
    options: &SimulateArguments,
    manifest: Manifest,
    host: &Terminal,
) -> Result<Exit, Failure> {
    let how = EnsembleOptions {
        out: options.out.as_deref(),
        resume: match (options.resume, options.mixed_builds) {
            (_, true) => Resume::MixedBuilds,
            (resume, false) => resume.into(),
        },
        record: options.record.as_ref(),
        record_every: options.record_every,
        checkpoints: options.checkpoints,
        threads: options.work.threads,
        // Of a manifest that is given it has been told.
        has_warned_of_build: options.manifest.is_some(),
        goes_on: false,
        figures: &options.figures.figures(),
        watch: options.watch,
        time_limit: None,
    };
    let (manifest, made) = match options.until {
        Some(within) => make_until(manifest, within, &how, host)?,
        None => {
            let made = make(&manifest, &how, host)?;
            (manifest, made)
        }
    };
    let manifest = &manifest;
    let MadeEnsemble {
        results,
        unrecorded,
    } = made;
    let shown = ResultsView {
        form: options.format.into(),
        how: &Presentation::default(),
        bonds: options.bonds,
        folder: options.out.as_deref(),
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
