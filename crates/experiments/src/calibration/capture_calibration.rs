//! Calibrates the rates of a scene from the captures of runs.
use stochc_estimate::{Coverage, FORMAT, Parameters, Rates};
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::scene::Scene;
use stochc_runtime::Settings;

use super::head_start::HeadStartTally;
use super::observation::Observations;
use super::{held_out, likelihood, observation};
use crate::OutcomeCounts;

/// Observations of a scene for its calibration: waiting times, and captures shortly after releases.
#[derive(Debug)]
pub struct Calibration {
    pub(super) scene: Scene,
    pub(super) profile: Vec<f64>,
    pub(super) observations: Observations,
    head_starts: HeadStartTally,
    outcomes: OutcomeCounts,
    /// Reason why the first failed run failed.
    failure: Option<String>,
}

/// Error of a calibration with too few captures.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TooFew {
    /// Most runs failed.
    #[error(
        "{failed} of {runs} calibration runs failed ({reason}); correct the scene, or calibrate with more `--substeps`"
    )]
    FailedRuns {
        /// Number of failed runs.
        failed: usize,
        /// Number of runs.
        runs: usize,
        /// Reason of the first failure.
        reason: String,
    },
    /// There were no captures.
    #[error(
        "no block was captured in {runs} calibration runs; calibrate with a larger `--max-ticks`, or find out with `stochc check FILE --physics` \
         whether a face can attract blocks"
    )]
    NoCaptures {
        /// Number of runs.
        runs: usize,
    },
    /// There were captures, but too few.
    #[error(
        "only {captures} captures were observed, and rates need {}; calibrate with more `--runs`, or a larger `--max-ticks`",
        MIN
    )]
    FewCaptures {
        /// Number of observed captures.
        captures: u64,
    },
}

/// Smallest number of captures that allows a calibration.
pub(super) const MIN: u64 = 100;

impl Calibration {
    /// Returns a calibration of a scene without observations. `profile` is the density profile of
    /// the free blocks, from [`profile`](super::profile).
    pub fn new(scene: &Scene, profile: Vec<f64>) -> Calibration {
        Calibration {
            scene: scene.clone(),
            profile,
            observations: Observations::default(),
            head_starts: HeadStartTally::default(),
            outcomes: OutcomeCounts::default(),
            failure: None,
        }
    }

    /// Adds the waiting times of a run of the calibration program number `program`.
    pub fn observe(&mut self, program: usize, record: &RunRecord) {
        self.outcomes.add(&record.outcome);
        if let Outcome::Failed { reason, .. } = &record.outcome {
            self.failure.get_or_insert_with(|| reason.clone());
        }
        let history = observation::History::from_record(record);
        self.observations
            .add(program, &history, &self.profile, &self.scene);
        self.head_starts.add(&history);
    }

    /// Returns the number of observed captures.
    pub fn captures(&self) -> u64 {
        self.observations.captures()
    }

    /// Returns whether all runs failed.
    pub fn has_only_failures(&self) -> bool {
        self.outcomes.failed() == self.outcomes.finished()
    }

    /// Returns the longest useful observation of a face \[ticks\]. `None` without captures.
    pub fn longest_wait(&self) -> Option<f64> {
        self.observations.longest_wait()
    }

    /// Returns the calibrated rates. The runs used `settings` and `seed`.
    ///
    /// # Errors
    ///
    /// If there are too few captures.
    pub fn rates(&self, settings: &Settings, seed: u64) -> Result<Rates, TooFew> {
        let captures = self.observations.captures();
        if captures < MIN {
            return Err(self.too_few());
        }
        let intervals = self.observations.without_jams();
        let (parameters, covariance) = likelihood::fit(&intervals);
        let parameters = Parameters(parameters);
        let needs_test = self.scene.uncalibrated_term().is_some();
        let tested = needs_test.then(|| held_out::best(&intervals));
        let kinds = match tested {
            Some((true, _)) => held_out::kinds(&intervals, &parameters),
            _ => Vec::new(),
        };
        Ok(Rates {
            format: FORMAT,
            scene: self.scene.clone(),
            simulated: format!(
                "{} {}",
                settings.model.name(),
                settings.steps_in(&self.scene)
            ),
            seed,
            captures,
            parameters,
            covariance,
            profile: self.profile.clone(),
            free: self.scene.free.count,
            head_starts: self.head_starts.summary(),
            coverage: Coverage {
                highest: self.observations.highest,
                least_open: self.observations.least_open,
                least_free: self.observations.least_free,
            },
            kinds,
            held_out: tested.map(|(_, held_out)| held_out),
        })
    }

    /// Returns the reason why there are too few captures.
    fn too_few(&self) -> TooFew {
        let (captures, runs) = (self.captures(), self.outcomes.finished());
        let failed = self.outcomes.failed();
        match &self.failure {
            Some(reason) if 2 * failed > runs => TooFew::FailedRuns {
                failed,
                runs,
                reason: reason.clone(),
            },
            _ if captures == 0 => TooFew::NoCaptures { runs },
            _ => TooFew::FewCaptures { captures },
        }
    }
}
