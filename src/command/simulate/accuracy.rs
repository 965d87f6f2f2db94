//! Settings that a measurement finds, instead of the user.
use std::path::Path;
use std::sync::atomic::Ordering;

use stochc_ensemble::Manifest;
use stochc_ensemble::text::percent;
use stochc_ensemble::trade::{CandidateKinds, Extent, FINEST, Setup, Trade, choose, known, note};
use stochc_files::budget::TRADE;
use stochc_files::read_file;
use stochc_runtime::Settings;

use super::super::show::ResultsFormat;
use super::super::terminal::warn;
use super::SimulateArguments;
use super::arguments::MAX_TICKS;
use crate::exit::{Exit, Failure};
use crate::host::Host;
use crate::operations::runs::threads;
use crate::operations::trade;

/// Puts the cheapest setting that is accurate enough into a manifest; `false`: no runs are needed, an estimate is accurate enough.
///
/// The accuracy comes from the trade that the user names, or from one that is measured now.
pub(super) fn settle(
    options: &SimulateArguments,
    accuracy: f64,
    manifest: &mut Manifest,
    host: &dyn Host,
) -> Result<bool, Failure> {
    let trade = match &options.trade {
        Some(path) => read(path)?,
        None => measured(options, manifest, host)?,
    };
    let programs = known(&trade, manifest).map_err(Failure::usage)?;
    // Whoever asks for a folder, for single runs or captures, or for JSON, needs runs.
    let wants_times = options.out.is_none() && options.run.is_none() && !options.bonds;
    let among = match wants_times && options.format == ResultsFormat::Text {
        true => CandidateKinds::All,
        false => CandidateKinds::Runs,
    };
    let max_ticks = manifest.settings.max_ticks.unwrap_or(u64::MAX);
    match choose(&trade, &programs, max_ticks, accuracy, among) {
        Ok(choice) => {
            warn(&format!(
                "--accuracy {}: {}\n",
                percent(accuracy),
                choice.why
            ));
            let Some(settings) = choice.settings else {
                return Ok(false);
            };
            manifest.settings = Settings {
                max_ticks: manifest.settings.max_ticks,
                ..settings
            };
            Ok(true)
        }
        Err(reason) => Err(Failure::error(Exit::NotAccurate, reason)),
    }
}

/// Says on standard error what is known about settings that the user has chosen.
pub(super) fn comment(options: &SimulateArguments, manifest: &Manifest) -> Result<(), Failure> {
    let settings = &manifest.settings;
    if let Some(reduction) = settings.reduction {
        warn(&format!(
            "note: `{}` is a reduced model: it leaves out something that the scene has\n",
            reduction.name()
        ));
    }
    // Where it has chosen the setting, it has said why.
    let path = match (&options.trade, options.accuracy) {
        (Some(path), None) => path,
        _ => return Ok(()),
    };
    let trade = read(path)?;
    let programs = known(&trade, manifest).map_err(Failure::usage)?;
    match note(&trade, &programs, settings) {
        Some(note) => warn(&format!("note: {note}\n")),
        None => warn("note: the trade has not measured this setting\n"),
    }
    Ok(())
}

fn measured(
    options: &SimulateArguments,
    manifest: &Manifest,
    host: &dyn Host,
) -> Result<Trade, Failure> {
    warn(&format!(
        "--accuracy needs a measurement: {} s of it now; `stochc trade --out DIR` makes a better \
         one, for `--trade DIR`\n",
        options.budget.as_secs_f64()
    ));
    let setup = Setup {
        extent: Extent::Budget(options.budget),
        seed: manifest.seed,
        threads: threads(options.work.threads).get(),
        finest: FINEST,
        // By default the trade sets one, by the times that it finds.
        max_ticks: (manifest.settings.max_ticks).filter(|limit| *limit != MAX_TICKS),
        memory: None,
        stop: host.stop(),
    };
    let trade = trade::measured(&manifest.programs, &setup, host)?;
    if host.stop().load(Ordering::Relaxed) {
        return Err(Failure::silent(Exit::Interrupted));
    }
    Ok(trade)
}

/// Reads a `trade.json`, or the one in a folder.
fn read(path: &Path) -> Result<Trade, Failure> {
    let file = match path.is_dir() {
        true => path.join("trade.json"),
        false => path.to_owned(),
    };
    let shown = file.display();
    let bytes = read_file(&file, TRADE)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    Trade::from_json(&text).map_err(|reason| Failure::usage(format!("`{shown}`: {reason}")))
}
