//! Calibration of the rates of a scene with physical simulations.
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

use stochc_experiments::calibration::{Calibration, profile, programs};
use stochc_ir::scene::Scene;
use stochc_results::{EnsembleProgram, Manifest};
use stochc_runtime::Settings;
use stochc_runtime::rates::Rates;
use stochc_runtime::world::rate::RateWorld;

use super::in_memory::{all_runs, stopped};
use crate::check_text;
use crate::exit::{Exit, Failure};
use crate::facade::compile;
use crate::host::{Host, during};
use crate::progress::WorkProgress;

/// Number of runs of each program in a round of a calibration. One round takes about 30 s of CPU
/// time in the default scene.
pub const RUNS: u64 = 6;
/// Limit on the ticks of a run in a calibration. Longer runs are stopped.
pub const MAX_TICKS: u64 = 60_000;

/// Seed of calibrations. It differs from the default seed of `simulate`, so that calibrations are
/// tested with other random impulses.
pub const SEED: u64 = 0x5ca1_e000;

/// Number of captures per program that make the sampling error of the held-out error small.
const ENOUGH: u64 = 200;

/// Number of simulated ticks after which no further round starts.
const MANY_TICKS: u64 = 4_000_000;

/// Difference of the seeds of two rounds. Larger than the number of programs.
const ROUND: u64 = 1000;

/// Consequence of an interrupt.
const NOTHING: &str = "nothing was calibrated";

/// Effort of a calibration: settings, runs and threads.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Settings of the simulated runs.
    pub settings: Settings,
    /// Number of runs of each observed program. `None` means [`RUNS`], or as many as the held-out
    /// error needs.
    pub runs: Option<u64>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
}

impl Effort {
    /// Returns the default settings and the default number of runs of a calibration.
    pub fn usual(threads: Option<u16>) -> Effort {
        Effort {
            settings: Settings {
                max_ticks: Some(MAX_TICKS),
                ..Settings::default()
            },
            runs: None,
            seed: SEED,
            threads,
        }
    }
}

/// Calibrates the rates of a scene with physical simulations, without hardware faults and broken
/// bonds.
///
/// # Errors
/// If the scene cannot be set up, or the user interrupts.
pub fn measure(scene: &Scene, effort: &Effort, host: &dyn Host) -> Result<Rates, Failure> {
    if let Some(error) = RateWorld::unsupported(scene) {
        return Err(Failure::invalid_program(error.to_string()));
    }
    let scene = &scene.without_failures();
    let observed = observed(scene)?;
    let gas = gas(scene, effort, host)?;
    let enough = ENOUGH * observed.len() as u64;
    let mut calibration = Calibration::new(scene, gas);
    let mut manifest = Manifest::new(
        effort.settings.clone(),
        effort.seed,
        effort.runs.unwrap_or(RUNS),
        observed,
    );
    let is_adaptive = effort.runs.is_none() && scene.uncalibrated_term().is_some();
    if is_adaptive {
        // The first waiting times determine how long later runs are useful.
        manifest.runs = 1;
    }
    let mut ticks = 0;
    loop {
        let before = (calibration.captures(), ticks);
        let results = all_runs(&manifest, effort.threads, NOTHING, host)?;
        let observed = results.finished.each(|done| {
            ticks += done.record.ticks;
            calibration.observe(done.program, &done.record);
        });
        observed.map_err(Failure::usage)?;
        let is_useless =
            before == (calibration.captures(), ticks) || calibration.has_only_failures();
        if !is_adaptive || is_useless || calibration.captures() >= enough || ticks >= MANY_TICKS {
            break;
        }
        manifest.runs = RUNS;
        manifest.seed = manifest.seed.wrapping_add(ROUND);
        if let Some(useful) = calibration.longest_wait() {
            let useful = useful.ceil() as u64;
            let most = effort.settings.max_ticks.unwrap_or(useful);
            manifest.settings.max_ticks = Some(most.min(useful));
        }
    }
    calibration
        .rates(&effort.settings, effort.seed)
        .map_err(|error| Failure::error(Exit::UnsuccessfulRun, error.to_string()))
}

/// Returns the density profile of the free blocks, while the host shows the progress.
fn gas(scene: &Scene, effort: &Effort, host: &dyn Host) -> Result<Vec<f64>, Failure> {
    let percent = AtomicU32::new(0);
    let state = |_| WorkProgress {
        share: f64::from(percent.load(Ordering::Relaxed)) / 100.0,
        done: String::new(),
        more: "observing the free blocks".to_owned(),
    };
    let mut watch = |share: f64| {
        percent.store((100.0 * share) as u32, Ordering::Relaxed);
        if host.stop().load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    during(host, state, || {
        profile(scene, &effort.settings, effort.seed, &mut watch)
    })
    .map_err(|error| Failure::invalid_program(error.to_string()))?
    .ok_or_else(|| stopped(NOTHING))
}

/// Returns the calibration programs of a scene, without those that capture more blocks than the
/// scene has.
fn observed(scene: &Scene) -> Result<Vec<EnsembleProgram>, Failure> {
    let mut observed: Vec<EnsembleProgram> = Vec::new();
    let mut least = u64::MAX;
    for (name, text) in programs(scene) {
        let executables =
            compile(check_text(name, text)).map_err(|wrong| Failure::usage(wrong.to_string()))?;
        for mut executable in executables {
            let captures = executable.tables.captures() as u64;
            least = least.min(captures);
            if captures <= u64::from(scene.free.count) {
                executable.scene = scene.clone();
                observed.push(EnsembleProgram::new(name, Vec::new(), executable));
            }
        }
    }
    if observed.is_empty() {
        return Err(Failure::invalid_program(format!(
            "too few free blocks ({}): the structures of a calibration capture {least} or more; `stochc simulate --model rigid` needs no rates",
            scene.free.count
        )));
    }
    Ok(observed)
}
