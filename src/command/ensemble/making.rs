//! Makes the runs of an ensemble.
use std::path::Path;

use stochc_compiler::LintLevels;
use stochc_report::figures::Figures;
use stochc_report::presentation::Presentation;
use stochc_results::{Manifest, Resume};

use super::arguments::{MAX_UNTIL, MakingOptions, RUNS};
use crate::command::host::Terminal;
use crate::command::interrupt::stop_on_interrupt;
use crate::command::show::{ResultsView, TableFormat, show};
use crate::command::terminal::{argument, close, print};
use crate::exit::{Exit, Failure};
use crate::operations::ensemble::{EnsembleOptions, MadeEnsemble, can_record, judge_scenes, make};
use crate::operations::forecast::{cpu_time, forecast_to_text};
use crate::operations::precision::make_until;
use crate::operations::rates::MissingRates;
use crate::operations::runs::try_out_all;

impl MakingOptions {
    /// Returns the number of runs of each program in a new ensemble.
    pub fn new_runs(&self) -> u64 {
        let usual = if self.until.is_some() {
            MAX_UNTIL
        } else {
            RUNS
        };
        self.runs.unwrap_or(usual)
    }

    /// Returns the source of missing rates. A dry run does not calibrate.
    pub fn missing_rates(&self) -> MissingRates {
        if self.dry_run {
            MissingRates::Default
        } else {
            MissingRates::Calibration(self.work.threads)
        }
    }

    /// Returns the requested number of runs of each program. Returns `None` to keep the number of
    /// the stored ensemble.
    pub fn more_runs(&self) -> Option<u64> {
        self.runs.or(self.until.map(|_| MAX_UNTIL))
    }
}

/// Ensemble to run, and where its results go.
pub struct Ensemble<'a> {
    pub manifest: Manifest,
    /// Results folder. `None` if the results are not stored.
    pub out: Option<&'a Path>,
    /// Rule for runs that the folder already contains.
    pub resume: Resume,
    /// Whether warnings about the scenes were already reported by a check with the same settings.
    pub is_checked: bool,
    /// Levels of warnings about scenes.
    pub levels: &'a LintLevels,
    /// Size and format of the figures of a sweep.
    pub figures: Figures,
}

/// Checks that an ensemble can be run. Warns about its model and scenes.
pub fn judge(
    manifest: &Manifest,
    is_checked: bool,
    levels: &LintLevels,
    host: &Terminal,
) -> Result<(), Failure> {
    if let Some(reduction) = manifest.settings.reduction {
        close(&format!(
            "note: runs without {}, which the scene has\n",
            reduction.name()
        ));
    }
    try_out_all(manifest)?;
    judge_scenes(manifest, is_checked, levels, host)
}

/// Makes the runs of an ensemble and prints its results.
pub fn run(
    ensemble: Ensemble<'_>,
    options: &MakingOptions,
    host: &Terminal,
) -> Result<Exit, Failure> {
    let Ensemble { manifest, out, .. } = ensemble;
    stop_on_interrupt()?;
    can_record(&manifest, options.record.as_ref())?;
    judge(&manifest, ensemble.is_checked, ensemble.levels, host)?;
    if options.dry_run {
        let forecast = cpu_time(&manifest, host)?;
        print(&forecast_to_text(&forecast, options.work.threads))?;
        return Ok(Exit::Success);
    }
    let how = EnsembleOptions {
        out,
        resume: ensemble.resume,
        record: options.record.as_ref(),
        record_every: options.record_every,
        checkpoints: options.checkpoints,
        threads: options.work.threads,
        has_warned_of_build: false,
        measures_cpu: false,
        continues: false,
        figures: &ensemble.figures,
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
    let MadeEnsemble {
        results,
        unrecorded,
    } = made;
    let is_json = options.shown.output.json;
    let shown = ResultsView {
        form: if is_json {
            TableFormat::Json
        } else {
            TableFormat::Text
        },
        how: &Presentation::default(),
        captures: options.shown.captures,
        folder: out,
    };
    let exit = show(&manifest, &results.finished, &shown)?;
    if results.complete {
        close(&match out.map(argument) {
            Some(folder) => format!("Saved in {folder}. Next: stochc report {folder}\n"),
            None => "Not saved; `-o DIR` saves the results in a folder.\n".to_owned(),
        });
        return unrecorded.map_or(Ok(exit), Err);
    }
    Err(stopped(out))
}

/// Returns the failure of an interrupted ensemble.
pub fn stopped(out: Option<&Path>) -> Failure {
    let message = match out.map(argument) {
        Some(folder) => {
            format!("interrupted; finished runs are kept. Next: stochc resume {folder}\n")
        }
        None => "interrupted; with `--out DIR`, finished runs are kept\n".to_owned(),
    };
    Failure {
        exit: Exit::Interrupted,
        message,
    }
}
