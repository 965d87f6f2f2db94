//! Rates for the rate model, from files or from a calibration.
use std::path::{Path, PathBuf};

use stochc_experiments::calibration::{Calibration, PROGRAMS, profile};
use stochc_files::budget::RATES;
use stochc_files::read_file;
use stochc_ir::scene::Scene;
use stochc_results::{EnsembleProgram, Manifest};
use stochc_runtime::Settings;
use stochc_runtime::rates::Rates;
use stochc_runtime::world::rate::RateWorld;
use stochc_text::visible;

use super::in_memory::all_runs;
use crate::check_text;
use crate::exit::{Exit, Failure};
use crate::facade::compile;
use crate::host::Host;

/// Default number of runs of a calibration. They take about 30 s of CPU time in the default scene.
pub const RUNS: u64 = 6;
/// Limit on the ticks of a run in a calibration. Longer runs are stopped.
pub const MAX_TICKS: u64 = 60_000;

/// Seed of calibrations. It differs from the default seed of `simulate`, so that calibrations are
/// tested with other random impulses.
pub const SEED: u64 = 0x5ca1_e000;

/// Returns the rates for the scenes of all programs, without duplicates. Uses `known` and built-in
/// rates, and calibrates the other scenes.
///
/// # Errors
/// If the rate model does not support a program, or a calibration fails.
pub fn rates_for_scenes(
    known: &[Rates],
    programs: &[EnsembleProgram],
    threads: Option<u16>,
    host: &dyn Host,
) -> Result<Vec<Rates>, Failure> {
    let mut found: Vec<Rates> = Vec::new();
    for program in programs {
        supported(program)?;
        let scene = &program.scene;
        if found.iter().any(|rates| rates.are_of(scene)) {
            continue;
        }
        let rates = match Rates::known(known, scene) {
            Some(rates) => rates.clone(),
            None => {
                host.warn(&format!(
                    "calibrating the scene of {}, which has no rates; `stochc calibrate --out` keeps them\n",
                    program.name
                ));
                measure(scene, &Effort::usual(threads), host)?
            }
        };
        found.push(rates);
    }
    Ok(found)
}

/// Files of rates whose scene no program uses.
#[derive(Debug)]
pub struct UnusedRates<'a> {
    of: Vec<(&'a Path, &'a Rates)>,
}

impl<'a> UnusedRates<'a> {
    /// Creates a list of all files of rates. [`UnusedRates::remove_used`] then removes the used files.
    pub fn new(files: &'a [PathBuf], rates: &'a [Rates]) -> UnusedRates<'a> {
        let files = files.iter().map(PathBuf::as_path);
        UnusedRates {
            of: files.zip(rates).collect(),
        }
    }

    /// Removes the files with rates for one of the `scenes`.
    pub fn remove_used<'b>(&mut self, scenes: impl Iterator<Item = &'b Scene> + Clone) {
        let is_about = |rates: &Rates| scenes.clone().any(|scene| rates.are_of(scene));
        self.of.retain(|(_, rates)| !is_about(rates));
    }

    /// Returns a warning for each unused file.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        self.of.iter().map(|(path, _)| {
            format!(
                "warning: `{}` is not used: it is about another scene\n",
                visible(&path.to_string_lossy())
            )
        })
    }
}

/// Reads files of rates. Warns about files whose scene is not one of the `scenes`.
///
/// # Errors
/// If a file cannot be read.
pub fn read_rates_for<'a>(
    files: &[PathBuf],
    scenes: impl Iterator<Item = &'a Scene> + Clone,
    host: &dyn Host,
) -> Result<Vec<Rates>, Failure> {
    let rates = read_rate_files(files)?;
    let mut unused = UnusedRates::new(files, &rates);
    unused.remove_used(scenes);
    unused.notes().for_each(|note| host.warn(&note));
    Ok(rates)
}

/// Reads files of rates.
///
/// # Errors
/// If a file cannot be read.
pub(crate) fn read_rate_files(files: &[PathBuf]) -> Result<Vec<Rates>, Failure> {
    files.iter().map(|path| read(path)).collect()
}

/// Returns the known or built-in rates for a scene. Returns `None` if there are none, or the rate
/// model does not support the scene.
pub(crate) fn matching<'a>(known: &'a [Rates], scene: &Scene) -> Option<&'a Rates> {
    Rates::known(known, scene).filter(|_| RateWorld::unsupported(scene).is_none())
}

/// Checks that the rate model supports a program and its scene.
///
/// # Errors
/// If it does not. The error names the unsupported feature, and a model that supports it.
pub(crate) fn supported(program: &EnsembleProgram) -> Result<(), Failure> {
    match RateWorld::unsupported_by(program.tables(), &program.scene) {
        Some(error) => Err(Failure::invalid_program(format!(
            "{}: {error}",
            program.name
        ))),
        None => Ok(()),
    }
}

fn read(path: &Path) -> Result<Rates, Failure> {
    let shown = path.display();
    let bytes = read_file(path, RATES)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    Rates::from_text(&text).map_err(|reason| Failure::usage(format!("`{shown}`: {reason}")))
}

/// Effort of a calibration: settings, runs and threads.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Settings of the simulated runs.
    pub settings: Settings,
    /// Number of runs of each observed program.
    pub runs: u64,
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
            runs: RUNS,
            seed: SEED,
            threads,
        }
    }
}

/// Calibrates the rates of a scene with physical simulations, without hardware faults.
///
/// # Errors
/// If the scene cannot be set up, or the user interrupts.
pub fn measure(scene: &Scene, effort: &Effort, host: &dyn Host) -> Result<Rates, Failure> {
    if let Some(error) = RateWorld::unsupported(scene) {
        return Err(Failure::invalid_program(error.to_string()));
    }
    let scene = &Scene {
        faults: None,
        ..scene.clone()
    };
    let mut observed: Vec<EnsembleProgram> = Vec::new();
    let mut least = u64::MAX;
    for (name, text) in PROGRAMS {
        let executables =
            compile(check_text(name, text)).map_err(|wrong| Failure::usage(wrong.to_string()))?;
        for mut executable in executables {
            let captures = executable.tables.captures() as u64;
            least = least.min(captures);
            // Skip programs with more captures than the scene has free blocks.
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
    let gas = profile(scene, &effort.settings, effort.seed)
        .map_err(|error| Failure::invalid_program(error.to_string()))?;
    let manifest = Manifest::new(effort.settings.clone(), effort.seed, effort.runs, observed);
    let results = all_runs(&manifest, effort.threads, "nothing was calibrated", host)?;
    let mut calibration = Calibration::new(scene, gas);
    let observed = results
        .finished
        .each(|done| calibration.observe(&done.record));
    observed.map_err(Failure::usage)?;
    calibration
        .rates(&effort.settings, effort.seed)
        .map_err(|error| Failure::error(Exit::UnsuccessfulRun, error.to_string()))
}
