//! The manifest of an ensemble.
use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::Serialize;
use stochc_ir::sha256;
use stochc_runtime::{Model, Settings};

use super::ensemble_program::{EnsembleProgram, ProgramIdentity};
use super::error::ManifestError;
use super::limits::{FORMAT, MAX_PROGRAMS, MAX_RUNS};
use super::varied::{SweepAxes, Varied};
use crate::build::this_build;

/// Data that determine an ensemble. Stored as `manifest.json` in the results folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// Version of `stochc` that made the manifest.
    pub stochc: String,
    /// Settings of all runs. A sweep may change them for its points.
    pub settings: Settings,
    /// Seed of the ensemble. Every random draw depends on it and on the run number.
    pub seed: u64,
    /// Number of runs of each program. May grow, so it is not part of the identity.
    pub runs: u64,
    /// Builds that made the runs ([`crate::this_build`]), in order of first use. Not part of the
    /// identity.
    pub builds: Vec<String>,
    /// Programs in the order of the command line. A sweep has one for each point.
    pub programs: Vec<EnsembleProgram>,
}

/// Part of a manifest that determines the result of each run.
#[derive(Serialize)]
struct Identity<'a> {
    pub(super) format: u32,
    pub(super) stochc: &'a str,
    pub(super) settings: Settings,
    pub(super) seed: u64,
    pub(super) programs: Vec<ProgramIdentity<'a>>,
}

impl Manifest {
    /// Returns a manifest of this version and build of `stochc`.
    ///
    /// Programs with equal names get a number: `tower`, `tower (2)`.
    pub fn new(
        settings: Settings,
        seed: u64,
        runs: u64,
        programs: Vec<EnsembleProgram>,
    ) -> Manifest {
        let mut manifest = Manifest {
            stochc: env!("CARGO_PKG_VERSION").to_owned(),
            settings,
            seed,
            runs,
            builds: vec![this_build()],
            programs,
        };
        for i in 1..manifest.programs.len() {
            let (earlier, rest) = manifest.programs.split_at_mut(i);
            let taken = |name: &str| earlier.iter().any(|program| program.name == name);
            let name = rest[0].name.clone();
            let mut copy = 2;
            while taken(&rest[0].name) {
                rest[0].name = format!("{name} ({copy})");
                copy += 1;
            }
        }
        manifest
    }

    /// Returns the total number of runs of all programs.
    pub fn total(&self) -> u64 {
        self.runs.saturating_mul(self.programs.len() as u64)
    }

    /// Returns the error message for a run number that is out of range.
    pub fn no_such_run(&self, run: u64) -> String {
        match self.runs {
            1 => format!("run {run} is not there: the only run is 0"),
            runs => format!("run {run} is not among runs 0..{}", runs.saturating_sub(1)),
        }
    }

    /// Returns the SHA-256, in hexadecimal, of everything that determines a run.
    ///
    /// Does not depend on paths, the number of runs and the number of threads.
    pub fn identity(&self) -> String {
        let identity = Identity {
            format: FORMAT,
            stochc: &self.stochc,
            settings: self.settings.resolved(),
            seed: self.seed,
            programs: self
                .programs
                .iter()
                .map(EnsembleProgram::identity)
                .collect(),
        };
        sha256(&identity)
    }

    /// Returns the SHA-256, in hexadecimal, of everything that determines the runs of one program.
    ///
    /// Does not depend on the program's name in the ensemble or on other programs. A change of the
    /// source matters only if it changes the tables. The names in the tables and the name of the
    /// scene matter.
    pub fn runs_identity(&self, program: &EnsembleProgram) -> String {
        sha256(&(
            &self.stochc,
            self.settings_of(program).resolved(),
            self.seed,
            program.compiled.digest(),
            &program.scene,
        ))
    }

    /// Returns descriptions of the differences that prevent adding runs of `other` to this
    /// ensemble.
    pub fn differences(&self, other: &Manifest) -> Vec<String> {
        let mut found = Vec::new();
        let mut compare = |what: &str, there: &str, here: &str| {
            if there != here {
                found.push(format!("{what} is `{there}` there and `{here}` here"));
            }
        };
        let number = |n: u64| n.to_string();
        compare("the version", &self.stochc, &other.stochc);
        let seed = if self.uses(Model::Measured) && other.uses(Model::Measured) {
            "the checksum of the log"
        } else {
            "the seed"
        };
        compare(seed, &number(self.seed), &number(other.seed));
        for (what, there, here) in self.settings.differences(&other.settings) {
            compare(what, &there, &here);
        }
        let names = |of: &Manifest| {
            let names: Vec<_> = of.programs.iter().map(|p| p.name.as_str()).collect();
            names.join(", ")
        };
        compare("the list of programs", &names(self), &names(other));
        for (there, here) in self.programs.iter().zip(&other.programs) {
            if there.name == here.name {
                found.extend(there.difference(here));
            }
        }
        found
    }

    /// Checks that the ensemble has at least one run and is within the size limits.
    ///
    /// # Errors
    ///
    /// If the ensemble is empty or exceeds a limit.
    pub fn within_limits(&self) -> Result<(), ManifestError> {
        if self.programs.is_empty() || self.runs == 0 {
            return Err(ManifestError::Empty);
        }
        if self.runs > MAX_RUNS {
            return Err(ManifestError::TooManyRuns(self.runs));
        }
        let mut together: BTreeMap<String, usize> = BTreeMap::new();
        for program in &self.programs {
            *together.entry(program.point()).or_default() += 1;
        }
        match together.into_values().max() {
            Some(count) if count > MAX_PROGRAMS => Err(ManifestError::TooManyPrograms(count)),
            _ => Ok(()),
        }
    }

    /// Returns the settings for the runs of one program of the manifest.
    ///
    /// # Panics
    ///
    /// If the program has a setting that [`ChosenSetting::new`](super::ChosenSetting::new) rejects.
    pub fn settings_of(&self, program: &EnsembleProgram) -> Cow<'_, Settings> {
        if program.chosen.is_empty() {
            return Cow::Borrowed(&self.settings);
        }
        let mut settings = self.settings.clone();
        for chosen in &program.chosen {
            let applied = chosen.apply(&mut settings);
            applied.expect("settings are checked when they are chosen or read");
        }
        if settings.model != Model::Rate {
            settings.rates.clear();
        }
        Cow::Owned(settings)
    }

    /// Returns whether any program is run in this model.
    pub fn uses(&self, model: Model) -> bool {
        let mut programs = self.programs.iter();
        programs.any(|program| self.settings_of(program).model == model)
    }

    /// Returns whether a sweep varies settings.
    pub fn varies_settings(&self) -> bool {
        self.programs.iter().any(|it| !it.chosen.is_empty())
    }

    /// Returns the scene parameters and settings that a sweep varies.
    pub fn swept(&self) -> SweepAxes<'_> {
        let mut settings: Vec<&str> = Vec::new();
        for chosen in self.programs.iter().flat_map(|program| &program.chosen) {
            if !settings.contains(&chosen.name()) {
                settings.push(chosen.name());
            }
        }
        SweepAxes {
            numbers: self.axes(),
            settings,
        }
    }

    /// Returns the scene parameters that a sweep varies, in the order of the command line. Empty
    /// without a sweep.
    pub fn axes(&self) -> &[Varied] {
        let mut programs = self.programs.iter().map(|program| &program.varied[..]);
        programs
            .find(|varied| !varied.is_empty())
            .unwrap_or_default()
    }
}
