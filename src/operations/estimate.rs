//! Estimates of completion times with the rate model.
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use stochc_ir::table::PhaseId;
use stochc_report::estimate::{
    CompletionEstimate, Method, PhaseEstimate, RemainingEstimate, Share,
};
use stochc_results::{EnsembleProgram, Finished, Manifest, partial_run};
use stochc_runtime::rates::{EventState, Rates, estimate, remaining_time};
use stochc_runtime::{Model, Settings};

use super::in_memory::all_runs;
use super::rates::{matching, rates_for_scenes, read_rates_for, supported};
use super::results::read;
use crate::exit::{Exit, Failure};
use crate::host::Host;

/// Approximate number of captures that all runs of a program sample together.
const DRAWN: u64 = 1_000_000;

/// Largest number of runs of a program.
const MAX: u64 = 2000;
/// Smallest number of runs of a program.
const MIN: u64 = 20;

/// Options of an estimate.
#[derive(Clone, Copy, Debug)]
pub struct Estimating<'a> {
    /// Files with calibrated rates, in addition to built-in rates. A scene without rates is
    /// calibrated first if its estimate needs runs. Otherwise it gets the uncalibrated estimate.
    pub rates: &'a [PathBuf],
    /// Number of runs of each program in the rate model. `None` means that waiting times are summed
    /// along the dependency graph. For executables, `None` means enough runs to sample a million
    /// captures.
    pub runs: Option<u64>,
    /// Limit on the ticks of a run. Longer runs are stopped.
    pub max_ticks: u64,
    /// Seed of the runs.
    pub seed: u64,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
}

/// Estimates each program.
///
/// # Errors
/// If rates cannot be obtained, a scene cannot be set up, or the user interrupts.
pub fn estimates(
    programs: Vec<EnsembleProgram>,
    how: &Estimating<'_>,
    host: &dyn Host,
) -> Result<Vec<CompletionEstimate>, Failure> {
    programs.iter().try_for_each(supported)?;
    let given = read_rates_for(how.rates, programs.iter().map(|it| &it.scene), host)?;
    // Calibrate missing rates only once, before the first run.
    let known = match how.runs {
        Some(_) => rates_for_scenes(&given, &programs, how.threads, host)?,
        None => given,
    };
    let estimated = programs.into_iter().map(|program| {
        if host.stop().load(Ordering::Relaxed) {
            return Err(Failure {
                exit: Exit::Interrupted,
                message: "stopped; nothing was estimated\n".to_owned(),
            });
        }
        let rates = Rates::known_or_guessed(&known, &program.scene).filter(|_| how.runs.is_none());
        match rates.and_then(|rates| estimate_graph(&program, &rates)) {
            Some(estimate) => Ok(estimate),
            None => estimate_runs(program, &known, how, host),
        }
    });
    estimated.collect()
}

/// Estimates the completion time from waiting times along the dependency graph. Returns `None` if
/// this is not possible for the program.
fn estimate_graph(program: &EnsembleProgram, rates: &Rates) -> Option<CompletionEstimate> {
    let cost = estimate(program.parts(), Some(rates))?;
    let (tables, graph) = (program.tables(), &program.compiled.graph);
    let phases = tables.phases.iter().zip(&cost.phases);
    let phases = phases.filter(|(phase, _)| !phase.pre_attached);
    let name = |phase: PhaseId| tables.phases[phase.0 as usize].name.clone();
    let of_captures = cost.captures.iter().map(|capture| Share {
        event: graph.describe(capture.event, tables),
        phase: name(graph.event(capture.event).phase),
        share: capture.share,
    });
    let of_waits = (0..).zip(&cost.phases).map(|(phase, cost)| Share {
        event: "wait".to_owned(),
        phase: name(PhaseId(phase)),
        share: cost.wait,
    });
    let shares = of_captures.chain(of_waits).filter(|it| it.share > 0.0);
    let mut shares: Vec<Share> = shares.collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    Some(CompletionEstimate {
        program: program.name.clone(),
        method: Method::Graph {
            interaction: cost.interaction,
            error: cost.interaction.error(),
            is_first_guess: rates.is_guess(),
        },
        lower_bound: cost.lower_bound,
        completed: (cost.draws.len() - cost.stopped()) as u64,
        incomplete: cost.stopped() as u64,
        total: cost.total,
        phases: phases
            .map(|(phase, cost)| PhaseEstimate {
                name: phase.name.clone(),
                times: cost.times,
            })
            .collect(),
        shares,
    })
}

/// Estimates the remaining time of each run in progress of a results folder.
///
/// # Errors
/// If the folder cannot be read, or the rate model does not support its program.
pub fn remaining(
    folder: &Path,
    rates: &[PathBuf],
    host: &dyn Host,
) -> Result<Vec<RemainingEstimate>, Failure> {
    let (manifest, finished) = read(folder, host)?;
    let programs = &manifest.programs;
    programs.iter().try_for_each(supported)?;
    let given = read_rates_for(rates, programs.iter().map(|it| &it.scene), host)?;
    let mut found = Vec::new();
    let estimate = |done: &Finished| {
        let program = &programs[done.program];
        let Some(state) = partial_run(program, &done.record) else {
            return;
        };
        let rates = Rates::known_or_guessed(&given, &program.scene);
        let events = program.compiled.graph.events.iter().zip(&state.events);
        let events = events.filter(|(event, _)| !program.is_pre_attached(event.phase));
        let is_happened = |(_, state): &(_, &EventState)| matches!(state, EventState::Happened(_));
        found.push(RemainingEstimate {
            program: program.name.clone(),
            run: done.record.run,
            elapsed: done.record.ticks,
            happened: events.clone().filter(is_happened).count(),
            events: events.count(),
            remaining: (rates.as_deref())
                .and_then(|rates| remaining_time(program.parts(), rates, &state)),
            is_first_guess: rates.as_deref().is_none_or(Rates::is_guess),
            lower_bound: (rates.as_deref())
                .map(|rates| program.lower_bound(rates))
                .unwrap_or_default()
                .ignoring_faults(&program.scene),
        });
    };
    finished.each(estimate).map_err(Failure::usage)?;
    Ok(found)
}

fn estimate_runs(
    program: EnsembleProgram,
    known: &[Rates],
    how: &Estimating<'_>,
    host: &dyn Host,
) -> Result<CompletionEstimate, Failure> {
    let programs = vec![program];
    let settings = Settings {
        rates: match matching(known, &programs[0].scene) {
            Some(rates) => vec![rates.clone()],
            None => rates_for_scenes(known, &programs, how.threads, host)?,
        },
        max_ticks: Some(how.max_ticks),
        ..Settings::new(Model::Rate, 1)
    };
    let lower_bound = Rates::known(&settings.rates, &programs[0].scene)
        .map(|rates| programs[0].lower_bound(rates))
        .unwrap_or_default();
    let runs = (how.runs).unwrap_or((DRAWN / programs[0].captures().max(1)).clamp(MIN, MAX));
    let manifest = Manifest::new(settings, how.seed, runs, programs);
    manifest.within_limits().map_err(Failure::usage)?;
    let results = all_runs(&manifest, how.threads, "nothing was estimated", host)?;
    let finished = results.finished.to_vec().map_err(Failure::usage)?;
    let records: Vec<_> = finished.iter().map(|done| &done.record).collect();
    Ok(CompletionEstimate::from_runs(
        &manifest.programs[0],
        &records,
        lower_bound,
    ))
}
