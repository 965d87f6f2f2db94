//! Rates for the rate model, from files or from a calibration.
use std::path::{Path, PathBuf};

use stochc_files::budget::RATES;
use stochc_files::read_file;
use stochc_ir::scene::Scene;
use stochc_results::EnsembleProgram;
use stochc_runtime::rates::Rates;
use stochc_runtime::world::SceneError;
use stochc_runtime::world::rate::RateWorld;
use stochc_text::visible;

use super::calibration::{Effort, measure};
use crate::exit::Failure;
use crate::host::Host;

/// Source of rates that are neither given nor built in.
#[derive(Clone, Copy, Debug)]
pub enum MissingRates {
    /// Calibration of the scene, with this number of threads. `None` means one per core.
    Calibration(Option<u16>),
    /// Rates of the default scene, for a forecast of CPU time.
    Default,
}

/// Returns the rates for the scenes of all programs, without duplicates.
///
/// # Errors
/// See [`rates_for_scenes`].
pub fn rates_from(
    missing: MissingRates,
    known: &[Rates],
    programs: &[EnsembleProgram],
    host: &dyn Host,
) -> Result<Vec<Rates>, Failure> {
    match missing {
        MissingRates::Calibration(threads) => rates_for_scenes(known, programs, threads, host),
        MissingRates::Default => rates_for_forecast(known, programs, host),
    }
}

/// Returns the rates for the scenes of all programs, without duplicates. Uses `known` and built-in
/// rates, and calibrates the other scenes. A scene whose rates need a held-out error is not
/// calibrated, because this can take long.
///
/// # Errors
/// If the rate model does not support a program, a scene needs a file of rates, or a calibration
/// fails.
pub fn rates_for_scenes(
    known: &[Rates],
    programs: &[EnsembleProgram],
    threads: Option<u16>,
    host: &dyn Host,
) -> Result<Vec<Rates>, Failure> {
    let mut found: Vec<Rates> = Vec::new();
    let missing = without_rates(known, programs)?;
    if missing > 1 {
        host.note(&format!(
            "{missing} scenes have no rates. Calibrating each takes about 30 s of CPU time; `--model rigid` needs no rates\n"
        ));
    }
    for program in programs {
        let scene = &program.scene;
        if found.iter().any(|rates| rates.are_of(scene)) {
            continue;
        }
        let rates = match Rates::known(known, scene) {
            Some(rates) => rates.clone(),
            None => {
                host.note(&format!(
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

/// Returns rates for a forecast of CPU time. The rates of the default scene replace missing ones.
/// Prints the cost of the missing calibrations.
///
/// # Errors
/// If the rate model does not support a program, or a scene needs a file of rates.
fn rates_for_forecast(
    known: &[Rates],
    programs: &[EnsembleProgram],
    host: &dyn Host,
) -> Result<Vec<Rates>, Failure> {
    let missing = without_rates(known, programs)?;
    if missing > 0 {
        let scenes = if missing == 1 {
            "scene has"
        } else {
            "scenes have"
        };
        host.note(&format!(
            "{missing} {scenes} no rates. Calibrating each takes about 30 s of CPU time, which the forecast excludes\n"
        ));
    }
    let mut found: Vec<Rates> = Vec::new();
    for program in programs {
        if !found.iter().any(|rates| rates.are_of(&program.scene)) {
            let rates = Rates::known(known, &program.scene).cloned();
            let rates = rates.or_else(|| Rates::stand_in(&program.scene));
            found.push(rates.ok_or_else(|| no_rates(program))?);
        }
    }
    Ok(found)
}

/// Returns the number of different scenes without rates.
///
/// # Errors
/// If the rate model does not support a program, or a scene needs a file of rates.
fn without_rates(known: &[Rates], programs: &[EnsembleProgram]) -> Result<usize, Failure> {
    let mut missing: Vec<&Scene> = Vec::new();
    for program in programs {
        supported(program)?;
        let scene = &program.scene;
        if Rates::known(known, scene).is_some() {
            continue;
        }
        if scene.uncalibrated_term().is_some() {
            return Err(no_rates(program));
        }
        if !missing.iter().any(|other| Rates::are_shared(other, scene)) {
            missing.push(scene);
        }
    }
    Ok(missing.len())
}

/// Returns the failure of a program whose scene needs a file of rates.
fn no_rates(program: &EnsembleProgram) -> Failure {
    Failure::invalid_program(format!("{}: {}", program.name, SceneError::NoRates))
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
