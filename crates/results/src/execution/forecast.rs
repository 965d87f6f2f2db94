//! Forecast of the CPU time of an ensemble, from trial runs.
use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use stochc_ir::table::PhaseId;

use crate::execution::thread_time;
use crate::execution::unless;
use crate::execution::{RunCancelled, attempt};
use crate::manifest::{EnsembleProgram, Manifest};

/// CPU time of all trial runs.
const EFFORT: Duration = Duration::from_millis(500);

/// Largest number of programs with trial runs, such as points of a sweep. They are evenly spaced in
/// the manifest.
const MAX_TRIED: usize = 8;

/// Largest number of points with trial runs in a sweep over settings. It is larger because the
/// costs of these points differ most.
const MAX_TRIED_SETTINGS: usize = 64;

/// Expected CPU time of an ensemble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CpuForecast {
    /// Number of runs of all programs.
    pub runs: u64,
    /// CPU time of all runs.
    pub time: Duration,
    /// Whether a trial was stopped early and its remaining time is unknown.
    pub is_lower_bound: bool,
}

/// Number and CPU time of the trial runs of one program.
#[derive(Clone, Copy, Debug, Default)]
struct Trials {
    runs: u32,
    seconds: f64,
    is_cut: bool,
}

/// Forecasts the CPU time of an ensemble from trial runs of half a second.
///
/// Tries the first runs of its programs, or of some programs if there are many. A trial that
/// exceeds its share of the time is stopped. For such a run, `expected_ticks` returns the length if
/// it is known. All scenes must be valid: see [`EnsembleProgram::try_out`]. Returns `None` if
/// `stop` is set.
pub fn forecast_cpu_time(
    manifest: &Manifest,
    expected_ticks: impl Fn(&EnsembleProgram) -> Option<f64>,
    stop: &AtomicBool,
) -> Option<CpuForecast> {
    let programs = &manifest.programs;
    let max_tried = if manifest.varies_settings() {
        MAX_TRIED_SETTINGS
    } else {
        MAX_TRIED
    };
    let tried = programs.len().min(max_tried);
    let mut trials = vec![Trials::default(); tried];
    let begun = thread_time();
    let share = EFFORT / tried.max(1) as u32;
    for number in 0..manifest.runs {
        for (i, trials) in trials.iter_mut().enumerate() {
            // The first trial of each program is always made.
            if number > 0 && (trials.is_cut || thread_time() - begun >= EFFORT) {
                continue;
            }
            let program = &programs[i * programs.len() / tried];
            trials.add(program, manifest, number, share, &expected_ticks, stop);
        }
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        if thread_time() - begun >= EFFORT {
            break;
        }
    }
    let mean = |trials: &Trials| trials.seconds / f64::from(trials.runs.max(1));
    let mean = trials.iter().map(mean).sum::<f64>() / tried.max(1) as f64;
    let runs = manifest.total();
    Some(CpuForecast {
        runs,
        time: Duration::try_from_secs_f64(mean * runs as f64).unwrap_or(Duration::MAX),
        is_lower_bound: trials.iter().any(|trials| trials.is_cut),
    })
}

impl Trials {
    /// Makes a trial run that takes at most `share` of CPU time.
    fn add(
        &mut self,
        program: &EnsembleProgram,
        manifest: &Manifest,
        number: u64,
        share: Duration,
        expected_ticks: impl Fn(&EnsembleProgram) -> Option<f64>,
        stop: &AtomicBool,
    ) {
        let begun = thread_time();
        let last = Cell::new((0, PhaseId(0)));
        // The time before the first tick is spent on setting up the scene.
        let first_tick = Cell::new(None);
        let mut watch = |tick, phase| {
            last.set((tick, phase));
            // Reading the clock takes about as long as a tick of a small scene.
            if tick % 16 == 0 {
                let now = thread_time();
                let first = first_tick.get().unwrap_or(now);
                first_tick.set(Some(first));
                if now - first > share {
                    return ControlFlow::Break(());
                }
            }
            unless(stop)
        };
        let simulate = || {
            let settings = manifest.settings_of(program);
            let record = program.run(&settings, manifest.seed, number, &mut watch);
            record.map_err(|_| RunCancelled)
        };
        let is_cut = attempt(number, simulate, || last.get()).is_none();
        let ended = thread_time();
        let ticking = ended - first_tick.get().unwrap_or(ended);
        self.runs += 1;
        self.seconds += (ended - begun).as_secs_f64();
        if is_cut {
            let made = last.get().0.max(1) as f64;
            let limit = manifest
                .settings
                .max_ticks
                .map_or(f64::INFINITY, |it| it as f64);
            let expected = expected_ticks(program).map(|ticks| ticks.min(limit));
            match expected.filter(|ticks| *ticks > made) {
                Some(ticks) => self.seconds += ticking.as_secs_f64() * (ticks / made - 1.0),
                None => self.is_cut = true,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::Executable;
    use stochc_runtime::{Model, Settings};

    use super::*;

    /// Returns an ensemble of one random capture without physics.
    fn manifest(max_ticks: u64) -> Manifest {
        let text = "assembly one { seed plate 3 x 3 { M at (1, 1) }\nphase grow { M.up -> A } }";
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let mut checked = stochc_compiler::check("one.sa", &mut reader, Default::default());
        let executable: Executable = checked.programs.remove(0).into_executable().unwrap();
        let program = EnsembleProgram::new("one", Vec::new(), executable);
        let settings = Settings {
            max_ticks: Some(max_ticks),
            ..Settings::new(Model::Rigid, 1)
        };
        Manifest::new(settings, 1, 400, vec![program])
    }

    #[test]
    fn the_forecast_scales_with_the_number_of_runs() {
        let manifest = manifest(100);
        let begun = thread_time();
        let stop = AtomicBool::new(false);
        let forecast = forecast_cpu_time(&manifest, |_| None, &stop).unwrap();
        assert!((thread_time() - begun) < 10 * EFFORT);
        assert!(
            !forecast.is_lower_bound && forecast.runs == 400,
            "{forecast:?}"
        );
        let begun = thread_time();
        for number in 0..40 {
            let mut watch = |_, _| ControlFlow::Continue(());
            let run = manifest.programs[0].run(&manifest.settings, 1, number, &mut watch);
            run.unwrap();
        }
        let ratio = forecast.time.as_secs_f64() / (10.0 * (thread_time() - begun).as_secs_f64());
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_stopped_trial_is_extrapolated() {
        let mut manifest = manifest(1 << 40);
        // Without free blocks, no run completes.
        manifest.programs[0].scene.free.count = 0;
        let stop = AtomicBool::new(false);
        let forecast =
            |expected: Option<f64>| forecast_cpu_time(&manifest, |_| expected, &stop).unwrap();
        let unknown = forecast(None);
        assert!(
            unknown.is_lower_bound && unknown.time >= 400 * EFFORT / 2,
            "{unknown:?}"
        );
        let known = forecast(Some(1e12));
        assert!(
            !known.is_lower_bound && known.time > 100 * unknown.time,
            "{known:?}"
        );
    }
}
