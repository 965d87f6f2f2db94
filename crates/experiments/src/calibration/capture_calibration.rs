//! Calibrates the rates of a scene from the captures of runs.
use stochc_estimate::{Coverage, FORMAT, Parameters, Rates};
use stochc_ir::record::RunRecord;
use stochc_ir::scene::Scene;
use stochc_runtime::Settings;

use super::head_start::HeadStartTally;
use super::observation::Observations;
use super::{likelihood, observation};

/// Programs whose runs are observed for a calibration, as name and source.
///
/// In each program, a structure grows. Observing single blocks next to a fixed structure would give
/// errors of 5 to 10 %.
pub const PROGRAMS: [(&str, &str); 25] = [
    ("towers", include_str!("programs/towers.sa")),
    ("wall", include_str!("programs/wall.sa")),
    ("corner", include_str!("programs/corner.sa")),
    ("slot", include_str!("programs/slot.sa")),
    ("arms", include_str!("programs/arms.sa")),
    ("floor", include_str!("programs/floor.sa")),
    ("pairs", include_str!("programs/pairs.sa")),
    ("spread", include_str!("programs/spread.sa")),
    ("drop", include_str!("programs/drop.sa")),
    ("lift", include_str!("programs/lift.sa")),
    ("pile", include_str!("programs/pile.sa")),
    ("stagger", include_str!("programs/stagger.sa")),
    ("quincunx", include_str!("programs/quincunx.sa")),
    ("gap", include_str!("programs/gap.sa")),
    ("solid", include_str!("programs/solid.sa")),
    ("late", include_str!("programs/late.sa")),
    ("alone", include_str!("programs/alone.sa")),
    ("apart", include_str!("programs/apart.sa")),
    ("row", include_str!("programs/row.sa")),
    ("hook", include_str!("programs/hook.sa")),
    ("crossbar", include_str!("programs/crossbar.sa")),
    ("winding", include_str!("programs/winding.sa")),
    ("posts", include_str!("programs/posts.sa")),
    ("sheet", include_str!("programs/sheet.sa")),
    ("fin", include_str!("programs/fin.sa")),
];

/// Observations of a scene for its calibration: waiting times, and captures shortly after releases.
#[derive(Debug)]
pub struct Calibration {
    pub(super) scene: Scene,
    pub(super) profile: Vec<f64>,
    pub(super) observations: Observations,
    head_starts: HeadStartTally,
}

/// Error of a calibration with too few captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFew {
    /// Number of observed captures.
    pub captures: u64,
}

impl std::fmt::Display for TooFew {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "only {} captures were observed, and rates need {MIN}; more runs, or a larger `--max-ticks`, give more",
            self.captures
        )
    }
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
        }
    }

    /// Adds the waiting times of a run.
    pub fn observe(&mut self, record: &RunRecord) {
        let history = observation::History::from_record(record);
        self.observations
            .add(&history, &self.profile, self.scene.free.count);
        self.head_starts.add(&history);
    }

    /// Returns the calibrated rates. The runs used `settings` and `seed`.
    ///
    /// # Errors
    ///
    /// If there are too few captures.
    pub fn rates(&self, settings: &Settings, seed: u64) -> Result<Rates, TooFew> {
        let captures = self.observations.captures();
        if captures < MIN {
            return Err(TooFew { captures });
        }
        let (parameters, covariance) = likelihood::fit(&self.observations.without_jams());
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
            parameters: Parameters(parameters),
            covariance,
            profile: self.profile.clone(),
            free: self.scene.free.count,
            head_starts: self.head_starts.summary(),
            coverage: Coverage {
                highest: self.observations.highest,
                least_open: self.observations.least_open,
                least_free: self.observations.least_free,
            },
        })
    }
}
