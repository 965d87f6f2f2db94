//! Trade of accuracy for speed: a sweep over settings, and its summary.
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

use stochc_experiments::trade::{Trade, candidates};
use stochc_report::figures::Figures;
use stochc_results::recording::EVERY;
use stochc_results::{EnsembleProgram, Interval, Manifest, Results};
use stochc_runtime::Settings;
use stochc_text::visible;

use super::ensemble::{EnsembleOptions, make};
use super::precision::make_until;
use crate::exit::Failure;
use crate::host::Host;

/// Default number of runs of each program with each combination of settings.
const RUNS: u64 = 30;

/// Largest number of runs of each program with each combination of settings. Used if a time limit
/// or a precision is given.
const MAX_RUNS: u64 = 10_000;

/// Options of a trade.
#[derive(Clone, Copy, Debug)]
pub struct TradeSetup<'a> {
    /// Number of runs of each program with each combination of settings. `None` means the default.
    pub runs: Option<u64>,
    /// Time limit for starting runs. `None` if there is no limit.
    pub time: Option<Duration>,
    /// Required precision: half-width of the 95 % confidence interval, divided by the mean. `None`
    /// if the number of runs is fixed.
    pub until: Option<f64>,
    /// Number of substeps of the reference setting.
    pub finest: u32,
    /// Limit on the ticks of a run. Longer runs are stopped.
    pub max_ticks: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
    /// Results folder. `None` if the results stay in memory.
    pub out: Option<&'a Path>,
    /// Whether to resume an interrupted trade in the folder.
    pub resume: bool,
    /// Size and format of the figure.
    pub figures: &'a Figures,
}

/// Measured trade between speed and accuracy.
#[derive(Debug)]
pub struct MeasuredTrade {
    /// Manifest of the ensemble with all settings.
    pub manifest: Manifest,
    /// Comparison of the settings.
    pub trade: Trade,
    /// Whether all runs are finished.
    pub is_complete: bool,
}

/// Returns the manifest of all programs with all candidate settings. Omits settings that a program
/// does not support, and warns about them.
///
/// # Errors
/// If the scene of a program cannot be set up.
pub fn manifest(
    programs: Vec<EnsembleProgram>,
    setup: &TradeSetup<'_>,
    host: &dyn Host,
) -> Result<Manifest, Failure> {
    let settings = Settings {
        max_ticks: Some(setup.max_ticks),
        ..Settings::default()
    };
    let is_limited = setup.time.is_some() || setup.until.is_some();
    let usual = if is_limited { MAX_RUNS } else { RUNS };
    let runs = setup.runs.unwrap_or(usual);
    let manifest = Manifest::new(settings, setup.seed, runs, programs);
    let mut points = vec![Vec::new(); manifest.programs.len()];
    for chosen in candidates(setup.finest) {
        let at_setting = manifest.programs.iter().map(|it| it.at(&chosen));
        let at_setting: Vec<EnsembleProgram> = at_setting.collect();
        let error = |program: &EnsembleProgram| {
            let error = program.try_out(&manifest.settings_of(program)).err()?;
            Some(format!("{}: {error}", visible(&program.name)))
        };
        match at_setting.iter().find_map(error) {
            None => {
                let points = points.iter_mut().zip(at_setting);
                points.for_each(|(points, point)| points.push(point));
            }
            // The program supports none of the settings.
            Some(reason) if points.iter().all(Vec::is_empty) => {
                return Err(Failure::invalid_program(reason));
            }
            Some(reason) => host.note(&format!("note: left out, {reason}\n")),
        }
    }
    let points = points.into_iter().flatten().collect();
    let manifest = Manifest {
        programs: points,
        ..manifest
    };
    manifest.within_limits().map_err(Failure::usage)?;
    Ok(manifest)
}

/// Makes the runs of a trade, and compares the settings.
///
/// # Errors
/// If the results folder cannot be used. Finished runs are not lost.
pub fn measured(
    manifest: Manifest,
    setup: &TradeSetup<'_>,
    host: &dyn Host,
) -> Result<MeasuredTrade, Failure> {
    let how = EnsembleOptions {
        out: setup.out,
        resume: setup.resume.into(),
        record: None,
        record_every: EVERY,
        // Checkpoints are disabled, because the CPU time of a resumed run is unknown.
        checkpoints: Interval::Never,
        threads: setup.threads,
        has_warned_of_build: false,
        measures_cpu: false,
        continues: false,
        figures: setup.figures,
        watch: false,
        time_limit: setup.time,
    };
    let (manifest, made) = match setup.until {
        Some(within) => make_until(manifest, within, &how, host)?,
        None => {
            let made = make(&manifest, &how, host)?;
            (manifest, made)
        }
    };
    let Results { finished, complete } = made.results;
    let trade = Trade::from_runs(&manifest, &finished).map_err(Failure::usage)?;
    let is_stopped = host.stop().load(Ordering::Relaxed);
    Ok(MeasuredTrade {
        trade: trade.ok_or_else(|| Failure::usage("only one setting can compute the programs"))?,
        is_complete: complete || !is_stopped,
        manifest,
    })
}
