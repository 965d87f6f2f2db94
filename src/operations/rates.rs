//! Rates for `--model rate`: those of files, or measured now.
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

/// What is simulated if nothing is said: some 30 s of processor time in the default scene.
pub const RUNS: u64 = 6;
/// Ticks of a run, at most.
pub const MAX_TICKS: u64 = 60_000;

/// Not that of `simulate`: the kicks of a calibration are never those of what it is held against.
pub const SEED: u64 = 0x5ca1_e000;

/// Returns the rates of the scenes of programs, each once: those that are known, or come with
/// `stochc`. What has to be measured first takes so many threads.
///
/// # Errors
/// If what has to be measured cannot be.
pub fn of_scenes(
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
                    "measuring the rates of the scene of {}, of which there are none; `stochc calibrate --out` keeps them\n",
                    program.name
                ));
                measure(scene, &Effort::usual(threads), host)?
            }
        };
        found.push(rates);
    }
    Ok(found)
}

/// Files of rates that are about none of the scenes that they were given for.
#[derive(Debug)]
pub struct UnusedRates<'a> {
    of: Vec<(&'a Path, &'a Rates)>,
}

impl<'a> UnusedRates<'a> {
    /// Before a scene has been seen.
    pub fn new(files: &'a [PathBuf], rates: &'a [Rates]) -> UnusedRates<'a> {
        let files = files.iter().map(PathBuf::as_path);
        UnusedRates {
            of: files.zip(rates).collect(),
        }
    }

    /// Leaves those that are about none of these scenes either.
    pub fn not_of<'b>(&mut self, scenes: impl Iterator<Item = &'b Scene> + Clone) {
        let is_about = |rates: &Rates| scenes.clone().any(|scene| rates.are_of(scene));
        self.of.retain(|(_, rates)| !is_about(rates));
    }

    /// What is to be said of each.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        self.of.iter().map(|(path, _)| {
            format!(
                "warning: `{}` is not used: it is about another scene\n",
                visible(&path.to_string_lossy())
            )
        })
    }
}

/// Those that files hold, for scenes; files that are about none of them are told of.
///
/// # Errors
/// If one cannot be read.
pub fn of_files_for<'a>(
    files: &[PathBuf],
    scenes: impl Iterator<Item = &'a Scene> + Clone,
    host: &dyn Host,
) -> Result<Vec<Rates>, Failure> {
    let rates = of_files(files)?;
    let mut unused = UnusedRates::new(files, &rates);
    unused.not_of(scenes);
    unused.notes().for_each(|note| host.warn(&note));
    Ok(rates)
}

/// Those that files hold.
///
/// # Errors
/// If one cannot be read.
pub(crate) fn of_files(files: &[PathBuf]) -> Result<Vec<Rates>, Failure> {
    files.iter().map(|path| read(path)).collect()
}

/// Returns the rates of a scene that are known, or come with the program; `None` as well where no
/// rates speak of the scene.
pub(crate) fn at_hand<'a>(known: &'a [Rates], scene: &Scene) -> Option<&'a Rates> {
    Rates::known(known, scene).filter(|_| RateWorld::unsupported(scene).is_none())
}

/// Returns whether rates speak of a program and its scene.
///
/// # Errors
/// What they know nothing of, and what does.
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

/// How much is simulated.
#[derive(Clone, Debug)]
pub struct Effort {
    /// How.
    pub settings: Settings,
    /// Runs of each program.
    pub runs: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: Option<u16>,
}

impl Effort {
    /// As much as is usual.
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

/// Measures the rates of a scene by runs with physics.
///
/// # Errors
/// If it has none, or the runs are stopped.
pub fn measure(scene: &Scene, effort: &Effort, host: &dyn Host) -> Result<Rates, Failure> {
    if let Some(error) = RateWorld::unsupported(scene) {
        return Err(Failure::invalid_program(error.to_string()));
    }
    let mut observed: Vec<EnsembleProgram> = Vec::new();
    let mut least = u64::MAX;
    for (name, text) in PROGRAMS {
        let executables =
            compile(check_text(name, text)).map_err(|wrong| Failure::usage(wrong.to_string()))?;
        for mut executable in executables {
            let captures = executable.tables.captures() as u64;
            least = least.min(captures);
            // Blocks that are not there cannot be waited for.
            if captures <= u64::from(scene.free.count) {
                executable.scene = scene.clone();
                observed.push(EnsembleProgram::new(name, Vec::new(), executable));
            }
        }
    }
    if observed.is_empty() {
        return Err(Failure::invalid_program(format!(
            "there are too few free blocks ({}) for any of the structures by which rates are measured: they capture {least} and more; `stochc simulate --model rigid` needs no rates",
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
