//! When programs will be complete, by rates.
use std::path::PathBuf;

use stochc_ensemble::{EnsembleProgram, Manifest};
use stochc_report::estimate::Estimate;
use stochc_runtime::{Model, Settings};

use super::in_memory::all_runs;
use super::rates::of_scenes;
use super::runs::try_out_all;
use crate::exit::Failure;
use crate::host::Host;

/// Captures that are drawn of a program in all of its runs, about.
const DRAWN: u64 = 1_000_000;

/// Runs of a program, at most and at least.
const MOST: u64 = 2000;
const LEAST: u64 = 20;

/// How programs are estimated.
#[derive(Clone, Copy, Debug)]
pub struct Estimating<'a> {
    /// Files of rates; scenes that none is about are measured first.
    pub rates: &'a [PathBuf],
    /// Runs of each program; `None`: as many as draw a million captures.
    pub runs: Option<u64>,
    /// Ticks of a run, at most.
    pub max_ticks: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Runs at the same time; `None`: as many as there are cores.
    pub threads: Option<u16>,
}

/// Estimates each program.
///
/// # Errors
/// If the rates of a scene cannot be had, a scene cannot be set up, or it is stopped.
pub fn estimates(
    programs: Vec<EnsembleProgram>,
    how: &Estimating<'_>,
    host: &dyn Host,
) -> Result<Vec<Estimate>, Failure> {
    let settings = Settings {
        rates: of_scenes(how.rates, &programs, how.threads, host)?,
        max_ticks: Some(how.max_ticks),
        ..Settings::of(Model::Rate, 1)
    };
    let estimated = programs.into_iter().map(|program| {
        let runs = (how.runs).unwrap_or((DRAWN / program.captures().max(1)).clamp(LEAST, MOST));
        let manifest = Manifest::new(settings.clone(), how.seed, runs, vec![program]);
        manifest.within_limits().map_err(Failure::usage)?;
        try_out_all(&manifest)?;
        let results = all_runs(&manifest, how.threads, "nothing was estimated", host)?;
        let finished = results.finished.to_vec().map_err(Failure::usage)?;
        let records: Vec<_> = finished.iter().map(|done| &done.record).collect();
        Ok(Estimate::of(&manifest.programs[0], &records))
    });
    estimated.collect()
}
