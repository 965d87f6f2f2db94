//! Measuring what accuracy costs, and keeping that.
use std::path::Path;
use std::time::Duration;

use stochc_compiler::cost::estimate;
use stochc_ensemble::trade::{
    EstimatedSamples, MEASUREMENT_JOURNAL, MeasurementJournal, MeasurementProgress, Setup, Trade,
    candidates, has_entries, measure,
};
use stochc_ensemble::{
    CpuForecast, EnsembleProgram, FolderError, JournalError, Manifest, is_remnant,
};
use stochc_files::atomic::{self, Replaces};
use stochc_report::figures::{Figures, trade as trade_figure};
use stochc_runtime::Settings;
use stochc_runtime::world::SceneError;

use super::estimate::planned;
use super::forecast::cpu_time;
use super::rates::{at_hand, supported};
use crate::exit::{Exit, Failure};
use crate::host::{Host, during};
use crate::progress::of_trade;

/// Measures programs, and shows how far it is.
///
/// # Errors
/// If the scene of one cannot be set up.
pub fn measured(
    programs: &[EnsembleProgram],
    setup: &Setup,
    host: &dyn Host,
) -> Result<Trade, Failure> {
    let progress = MeasurementProgress::default();
    let state = |elapsed| of_trade(setup.extent, &progress, elapsed);
    let trade = during(host, state, || {
        measure(programs, setup, &estimated(programs), &progress)
    });
    trade.map_err(|(program, error)| {
        Failure::invalid_program(format!("{}: {error}", programs[program].name))
    })
}

/// Forecasts the CPU time of a trade with so many runs of each program at each setting.
///
/// Settings that cannot run a program are left out.
///
/// # Errors
/// If it is stopped.
pub fn forecast(
    programs: &[EnsembleProgram],
    setup: &Setup<'_>,
    runs: u64,
    host: &dyn Host,
) -> Result<CpuForecast, Failure> {
    let mut all = CpuForecast {
        runs: 0,
        time: Duration::ZERO,
        is_lower_bound: false,
    };
    for settings in candidates(setup.finest) {
        let settings = Settings {
            max_ticks: setup.max_ticks,
            ..settings
        };
        let manifest = Manifest::new(settings, setup.seed, runs, programs.to_vec());
        match cpu_time(&manifest, host) {
            Ok(forecast) => {
                all.runs += forecast.runs;
                all.time = all.time.saturating_add(forecast.time);
                all.is_lower_bound |= forecast.is_lower_bound;
            }
            Err(failure) if failure.exit == Exit::Interrupted => return Err(failure),
            Err(_) => {}
        }
    }
    Ok(all)
}

/// What is known of programs without runs, by the rates that come with `stochc`; reading and compiling costs the other settings
/// nothing, and does not count here either.
fn estimated(programs: &[EnsembleProgram]) -> EstimatedSamples {
    let read = programs.iter().map(|program| {
        supported(program).map_err(|failure| failure.message)?;
        let rates = at_hand(&[], &program.scene).ok_or_else(|| SceneError::NoRates.to_string())?;
        let (planned, _) = planned(program).ok_or("it is compiled already, and has no plan")?;
        Ok((planned, rates))
    });
    match read.collect::<Result<Vec<_>, String>>() {
        Err(reason) => EstimatedSamples::none(programs.len(), reason),
        Ok(read) => EstimatedSamples::of(programs.len(), |program| {
            let (planned, rates) = &read[program];
            let cost = estimate(planned, Some(rates)).filter(|cost| !cost.draws.is_empty());
            cost.map(|cost| cost.draws)
                .ok_or_else(|| "no block is left for one of the captures".to_owned())
        }),
    }
}

/// What the folder of a trade knows already; `None`: it is kept nowhere.
///
/// # Errors
/// If the folder holds something else.
pub fn memory(
    out: Option<&Path>,
    resume: bool,
    programs: &[EnsembleProgram],
    seed: u64,
) -> Result<Option<MeasurementJournal>, Failure> {
    let Some(out) = out else { return Ok(None) };
    claim(out, resume).map_err(Failure::usage)?;
    let memory = MeasurementJournal::open(out, programs, seed);
    memory.map(Some).map_err(|error| cannot_go_on(out, &error))
}

/// Keeps a trade in its folder.
///
/// # Errors
/// Those of the file system.
pub fn keep(
    out: &Path,
    memory: MeasurementJournal,
    trade: &Trade,
    figures: &Figures,
) -> Result<(), Failure> {
    let cannot = |error: &dyn std::fmt::Display| {
        Failure::usage(format!("cannot write to `{}`: {error}", out.display()))
    };
    memory.close().map_err(|error| cannot(&error))?;
    write(out, trade, figures).map_err(|error| cannot(&error))
}

fn cannot_go_on(out: &Path, error: &FolderError) -> Failure {
    let shown = out.display();
    Failure::usage(match error {
        FolderError::Journal(JournalError::Foreign) => format!(
            "`{shown}` holds the trade of other programs, of another seed or of another build of `stochc`, \
             or the first line of its journal is damaged; choose another folder"
        ),
        error => error.to_string(),
    })
}

/// Makes a folder, or takes an empty one; to `resume`, one that holds a trade.
fn claim(out: &Path, resume: bool) -> Result<(), String> {
    let io = |error| unusable(out, &error);
    let is_ours = out.join(MEASUREMENT_JOURNAL).is_file();
    // What is left of a trade that has measured nothing is in nobody's way.
    let is_new = is_ours && !has_entries(out).map_err(io)?;
    match claim_empty(out, |name| is_new && name == MEASUREMENT_JOURNAL) {
        Err(_) if is_ours && resume => Ok(()),
        Err(refused) if is_ours => Err(format!(
            "{refused}, or go on with the trade in it by `--resume`"
        )),
        claimed => claimed,
    }
}

/// Makes a folder, or takes an empty one; locks, drafts of who was killed and what else `is_nobodys`, by its name, may be in it.
///
/// # Errors
/// In words.
pub fn claim_empty(out: &Path, is_nobodys: impl Fn(&str) -> bool) -> Result<(), String> {
    let io = |error| unusable(out, &error);
    let shown = out.display();
    if out.exists() && !out.is_dir() {
        return Err(format!(
            "`{shown}` is a file; choose another name for the folder"
        ));
    }
    atomic::make_folder(out).map_err(io)?;
    let entries = stochc_files::disk::list(out).map_err(io)?;
    let is_taken = entries.iter().any(|entry| {
        let name = entry.file_name().unwrap_or_default().to_string_lossy();
        !is_remnant(entry) && !is_nobodys(&name)
    });
    match is_taken {
        false => Ok(()),
        true => Err(format!(
            "`{shown}` is not empty; choose an empty or a new folder"
        )),
    }
}

fn unusable(out: &Path, error: &std::io::Error) -> String {
    format!("cannot use `{}`: {error}", out.display())
}

fn write(out: &Path, trade: &Trade, figures: &Figures) -> std::io::Result<()> {
    let mut files = figures.files(&trade_figure(figures.medium, trade))?;
    files.push(("trade.json".to_owned(), trade.to_json().into_bytes()));
    let mut files = files.iter();
    files.try_for_each(|(name, content)| {
        atomic::replace(&out.join(name), content, Replaces::Ordinary)
    })
}
