//! Calibrated rates of a scene.
use std::borrow::Cow;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face, StrictJsonError, strict_json};
use thiserror::Error;

use crate::geometry::neighbourhood::Neighbourhood;
use crate::geometry::rivals::Rivals;
use crate::geometry::surroundings::{around, blocked_around};
use crate::waits::head_start::{HeadStart, HeadStarts};
use crate::waits::held_out::{HeldOut, InaccurateRates};
use crate::waits::law::{KindFactor, Parameters, Surroundings};
use crate::waits::wait::Wait;

/// Capture rates of a scene, with their origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Rates {
    /// Version of the file format.
    pub format: u32,
    /// Calibrated scene.
    pub scene: Scene,
    /// Model and steps of the calibration runs.
    pub simulated: String,
    /// Seed of the runs.
    pub seed: u64,
    /// Number of observed captures.
    pub captures: u64,
    /// Parameters of the rate law.
    pub parameters: Parameters,
    /// Covariance of the parameters, row by row.
    pub covariance: Vec<f64>,
    /// Density of free blocks around the plate relative to their mean, by layers of one block
    /// length. The first layer contains the centres of blocks in the lowest cells.
    pub profile: Vec<f64>,
    /// Number of initially free blocks.
    pub free: u32,
    /// Head starts of released blocks.
    pub head_starts: Vec<HeadStart>,
    /// Range of the observations.
    pub coverage: Coverage,
    /// Factors of the rates by kind of surroundings, in order of the kinds. Empty if the rate law
    /// predicts held-out structures at least as well without them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kinds: Vec<KindFactor>,
    /// Error for structures outside of the calibration. `None` if all terms of the scene are part
    /// of the rate law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_out: Option<HeldOut>,
}

/// Range of the surroundings that the calibration covers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Highest capturing cell.
    pub highest: i32,
    /// Smallest observed fraction of a sphere of reach that is not obstructed.
    pub least_open: f64,
    /// Smallest observed fraction of the initial free blocks that were still free.
    pub least_free: f64,
}

/// Version of the format of [`Rates`]. No other version is read.
pub const FORMAT: u32 = 1;

/// Index of the parameter for a block opposite to the face.
const AHEAD: usize = 10;

/// Limit for passable gaps: the logarithm of 1/2. In a passable gap, the rate is more than half of
/// the rate in other cells.
const SLOWEST_GAP: f64 = -0.7;

/// Rates of built-in scenes, written by `stochc calibrate SCENE --out`.
const BUILT_IN: [&str; 1] = [include_str!("../data/hemisphere.rates")];

/// Returns the density of a [`profile`](Rates::profile) at a layer of cells. The density is
/// constant above the last layer of the profile.
pub fn density_in(profile: &[f64], layer: i32) -> f64 {
    let layer = usize::try_from(layer - 1).unwrap_or(0);
    profile
        .get(layer)
        .or(profile.last())
        .copied()
        .unwrap_or(1.0)
}

impl Rates {
    /// Returns the built-in rates of a scene. Returns `None` if there are none.
    pub fn built_in(scene: &Scene) -> Option<&'static Rates> {
        Rates::shipped().iter().find(|rates| rates.are_of(scene))
    }

    /// Returns whether blocks are known to [pass gaps](Rates::passes_gaps) in a built-in scene.
    pub fn pass_gaps(scene: &Scene) -> bool {
        Rates::built_in(scene).is_some_and(Rates::passes_gaps)
    }

    /// Returns all built-in rates. The rates of the default scene come first.
    pub(crate) fn shipped() -> &'static [Rates] {
        static ALL: LazyLock<Vec<Rates>> = LazyLock::new(|| {
            let all = BUILT_IN.iter();
            all.filter_map(|text| Rates::from_text(text).ok()).collect()
        });
        &ALL
    }

    /// Returns the given or built-in rates of a scene. Returns `None` if there are none.
    pub fn known<'a>(given: &'a [Rates], scene: &Scene) -> Option<&'a Rates> {
        let given = given.iter().find(|rates| rates.are_of(scene));
        given.or_else(|| Rates::built_in(scene))
    }

    /// Returns the given or built-in rates of a scene, or an [uncalibrated
    /// estimate](Rates::first_guess). Returns `None` if no estimate is possible.
    pub fn known_or_guessed<'a>(given: &'a [Rates], scene: &Scene) -> Option<Cow<'a, Rates>> {
        let known = Rates::known(given, scene).map(Cow::Borrowed);
        known.or_else(|| Rates::first_guess(scene).map(Cow::Owned))
    }

    /// Returns the rates of the default scene, declared as rates of another scene. Waiting times are
    /// wrong, but runs take about as much CPU time as with calibrated rates.
    pub fn stand_in(scene: &Scene) -> Option<Rates> {
        Rates::shipped().first().map(|rates| Rates {
            scene: scene.clone(),
            ..rates.clone()
        })
    }

    /// Returns whether the rates are valid for a scene.
    pub fn are_of(&self, scene: &Scene) -> bool {
        Rates::are_shared(&self.scene, scene)
    }

    /// Returns whether two scenes have the same rates.
    pub fn are_shared(first: &Scene, second: &Scene) -> bool {
        let mut alike = second.without_failures();
        // Name, number of open faces per block and messages do not affect waiting times.
        alike.name.clone_from(&first.name);
        alike.block.faces = first.block.faces;
        alike.messages.clone_from(&first.messages);
        first.without_failures() == alike
    }

    /// Returns whether blocks certainly enter gaps about as fast as other cells. In some scenes,
    /// blocks jam in gaps.
    pub fn passes_gaps(&self) -> bool {
        let variance = self.covariance[AHEAD * (Parameters::COUNT + 1)];
        variance > 0.0 && self.parameters.0[AHEAD] - 2.0 * variance.sqrt() > SLOWEST_GAP
    }

    /// Returns the relative density of free blocks at a layer of cells. It is constant above the
    /// calibrated layers.
    pub fn density(&self, layer: i32) -> f64 {
        density_in(&self.profile, layer)
    }

    /// Returns the head starts in the calibrated scene.
    pub fn head_starts(&self) -> HeadStarts<'_> {
        HeadStarts::in_scene(&self.scene, &self.head_starts)
    }

    /// Returns the surroundings of an open face. See [`around`].
    pub fn surroundings(
        &self,
        cell: Cell,
        direction: Face,
        near: Neighbourhood,
        open: impl Fn(Cell) -> Option<Face>,
    ) -> Surroundings {
        let near = near.in_world_of(&self.scene);
        Surroundings {
            density: self.density(cell.z),
            ..around(cell, direction, near, open)
        }
    }

    /// Returns the waiting time of a face with open faces nearby.
    pub fn wait_among(
        &self,
        cell: Cell,
        direction: Face,
        near: Neighbourhood,
        rivals: Rivals,
        cold: bool,
    ) -> Wait {
        let near = near.in_world_of(&self.scene);
        self.wait(&Surroundings {
            density: self.density(cell.z),
            rivals,
            cold,
            ..blocked_around(cell, direction, near)
        })
    }

    /// Returns the waiting time of a face with these surroundings.
    pub fn wait(&self, surroundings: &Surroundings) -> Wait {
        let mut wait = self.parameters.wait(surroundings);
        if !self.kinds.is_empty() {
            wait.rate *= KindFactor::find(&self.kinds, surroundings);
        }
        wait
    }

    /// Checks that commands may use the rates.
    ///
    /// # Errors
    ///
    /// If their held-out error is too large.
    pub fn check_accuracy(&self) -> Result<(), InaccurateRates> {
        match self.held_out {
            Some(held_out) if !held_out.is_accurate() => Err(InaccurateRates(held_out)),
            _ => Ok(()),
        }
    }

    /// Returns the size of the largest structure in the calibration.
    ///
    /// Returns `None` for uncalibrated estimates.
    pub fn largest_structure(&self) -> Option<u32> {
        let part = 1.0 - self.coverage.least_free;
        let blocks = (part * f64::from(self.free)).round();
        (!self.is_guess()).then_some(blocks as u32)
    }

    /// Returns the rates as a file: a JSON object on several lines.
    pub fn to_text(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Reads rates from a file.
    ///
    /// # Errors
    ///
    /// If the file is invalid, or the held-out error of its rates is too large.
    pub fn from_text(text: &str) -> Result<Rates, UnreadableRates> {
        let rates: Rates = strict_json(text.as_bytes())?;
        rates.check_accuracy()?;
        Ok(rates)
    }
}

/// Error of a file without usable rates.
#[derive(Debug, Error)]
pub enum UnreadableRates {
    /// The file does not contain valid rates.
    #[error("it is not a file of rates by `stochc calibrate`: {0}")]
    Invalid(#[from] StrictJsonError),
    /// The held-out error is too large.
    #[error(transparent)]
    Inaccurate(#[from] InaccurateRates),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
enum InvalidRates {
    #[error("its format is {0}, and this is {FORMAT}; calibrate again")]
    Format(u32),
    #[error("its number of parameters is wrong")]
    Parameters,
    #[error("the size of its covariance is wrong")]
    Covariance,
    #[error("a parameter is out of range")]
    ParameterRange,
    #[error("its profile is invalid")]
    Profile,
    #[error("its head starts are invalid")]
    HeadStarts,
    #[error("its factors by kind of surroundings are invalid")]
    Kinds,
    #[error("its held-out error is missing or invalid; calibrate again")]
    HeldOut,
    #[error("a number is not finite")]
    NotFinite,
}

// `Stored` ensures that all numbers are finite.
impl Eq for Rates {}

/// Rates before validation.
#[derive(Deserialize)]
struct Stored {
    format: u32,
    scene: Scene,
    simulated: String,
    seed: u64,
    captures: u64,
    parameters: Vec<f64>,
    covariance: Vec<f64>,
    profile: Vec<f64>,
    free: u32,
    head_starts: Vec<HeadStart>,
    coverage: Coverage,
    #[serde(default)]
    kinds: Vec<KindFactor>,
    held_out: Option<HeldOut>,
}

impl TryFrom<Stored> for Rates {
    type Error = InvalidRates;

    fn try_from(stored: Stored) -> Result<Rates, InvalidRates> {
        let Stored {
            format,
            scene,
            simulated,
            seed,
            captures,
            parameters,
            covariance,
            profile,
            free,
            head_starts,
            coverage,
            kinds,
            held_out,
        } = stored;
        if format != FORMAT {
            return Err(InvalidRates::Format(format));
        }
        let parameters = <[f64; Parameters::COUNT]>::try_from(parameters)
            .map_err(|_| InvalidRates::Parameters)?;
        if covariance.len() != Parameters::COUNT * Parameters::COUNT {
            return Err(InvalidRates::Covariance);
        }
        // Beyond e^30 waiting times are meaningless, and sums overflow.
        if (parameters.iter()).any(|value| !(-30.0..=30.0).contains(value)) {
            return Err(InvalidRates::ParameterRange);
        }
        let is_density = |value: &f64| (0.0..=1e6).contains(value);
        if profile.is_empty() || profile.len() > MAX_LAYERS || !profile.iter().all(is_density) {
            return Err(InvalidRates::Profile);
        }
        let is_start = |start: &HeadStart| {
            (0.0..=1.0).contains(&start.probability) && (0.0..=1e9).contains(&start.ticks)
        };
        if head_starts.len() > MAX_HEAD_STARTS || !head_starts.iter().all(is_start) {
            return Err(InvalidRates::HeadStarts);
        }
        let is_factor = |it: &KindFactor| (1e-9..=1e9).contains(&it.factor);
        if !kinds.is_sorted_by(|a, b| a.kind < b.kind) || !kinds.iter().all(is_factor) {
            return Err(InvalidRates::Kinds);
        }
        let is_error = |it: HeldOut| it.error >= 0.0 && it.error.is_finite() && it.sampling >= 0.0;
        if !held_out.map_or(scene.uncalibrated_term().is_none(), is_error) {
            return Err(InvalidRates::HeldOut);
        }
        let others = [coverage.least_open, coverage.least_free];
        if covariance
            .iter()
            .chain(&others)
            .any(|value| !value.is_finite())
        {
            return Err(InvalidRates::NotFinite);
        }
        Ok(Rates {
            format: FORMAT,
            scene,
            simulated,
            seed,
            captures,
            parameters: Parameters(parameters),
            covariance,
            profile,
            free,
            head_starts,
            coverage,
            kinds,
            held_out,
        })
    }
}

const MAX_LAYERS: usize = 1000;

const MAX_HEAD_STARTS: usize = 100;

#[cfg(test)]
mod tests {
    use stochc_ir::scene::BondStrength;

    use super::*;
    use crate::waits::held_out::MAX_HELD_OUT_ERROR;

    #[test]
    fn built_in_rates_survive_a_round_trip() {
        for text in BUILT_IN {
            let rates = Rates::from_text(text).expect("it is sound");
            assert_eq!(rates.to_text(), text);
            let renamed = Scene {
                name: "another".to_owned(),
                ..rates.scene.clone()
            };
            assert_eq!(Rates::built_in(&renamed), Some(&rates));
            let mut denser = renamed;
            denser.free.count += 1;
            assert_eq!(Rates::built_in(&denser), None);
        }
    }

    #[test]
    fn rejects_impossible_values() {
        let valid = Rates::from_text(BUILT_IN[0]).expect("it is sound");
        let factor = |kind| KindFactor { kind, factor: 2.0 };
        let kinds = [factor(1), factor(2)];
        let tested = Rates {
            kinds: kinds.to_vec(),
            held_out: Some(HeldOut {
                error: MAX_HELD_OUT_ERROR,
                sampling: 0.05,
            }),
            ..valid.clone()
        };
        let read = Rates::from_text(&tested.to_text()).expect("it is sound");
        assert_eq!(read, tested);
        let valid = tested;
        let corrupted: [fn(&mut Rates); 10] = [
            |rates| rates.format += 1,
            |rates| rates.parameters.0[3] = 1e300,
            |rates| rates.profile.clear(),
            |rates| rates.profile[0] = -1.0,
            |rates| rates.covariance.truncate(7),
            |rates| rates.head_starts[0].probability = 1.5,
            |rates| rates.kinds.swap(0, 1),
            |rates| rates.kinds[0].factor = 0.0,
            |rates| {
                rates.held_out = Some(HeldOut {
                    error: -0.1,
                    sampling: 0.0,
                })
            },
            |rates| {
                rates.scene.gravity = Some(1.0);
                rates.held_out = None;
            },
        ];
        for corrupt in corrupted {
            let mut rates = valid.clone();
            corrupt(&mut rates);
            assert!(Rates::from_text(&rates.to_text()).is_err());
        }
    }

    #[test]
    fn rates_do_not_depend_on_the_strength_of_bonds() {
        let rates = &Rates::shipped()[0];
        let mut scene = rates.scene.clone();
        let bond = scene.bond.as_mut().expect("blocks bond");
        *bond.strength_mut().expect("bonds can have a strength") = Some(BondStrength {
            force: Some(1.0),
            torque: None,
        });
        assert!(rates.are_of(&scene));
        scene.bond = None;
        assert!(!rates.are_of(&scene));
    }

    #[test]
    fn rejects_inaccurate_rates() {
        let mut rates = Rates::from_text(BUILT_IN[0]).expect("it is sound");
        rates.held_out = Some(HeldOut {
            error: 0.286,
            sampling: 0.073,
        });
        let refused = Rates::from_text(&rates.to_text());
        let refused = refused.expect_err("it must be rejected").to_string();
        assert!(
            refused.contains("28.6 % (sampling error 7.3 %)"),
            "{refused}"
        );
    }

    #[test]
    fn factors_apply_to_their_kind_of_surroundings() {
        let mut rates = Rates::from_text(BUILT_IN[0]).expect("it is sound");
        let cell = Cell::new(0, 0, 9);
        let [up, down] = [Face::Up, Face::Down].map(|face| {
            let near = Neighbourhood::EMPTY;
            rates.surroundings(cell, face, near, |_| None)
        });
        let before = [up, down].map(|it| rates.wait(&it).rate);
        rates.kinds = vec![KindFactor {
            kind: up.kind(),
            factor: 2.0,
        }];
        let after = [up, down].map(|it| rates.wait(&it).rate);
        assert_eq!(after, [2.0 * before[0], before[1]]);
    }

    #[test]
    fn rejects_unknown_fields() {
        let text = BUILT_IN[0].replacen("\"seed\"", "\"sead\": 1, \"seed\"", 1);
        let refused = Rates::from_text(&text)
            .expect_err("it must be rejected")
            .to_string();
        assert!(refused.contains("`sead`"), "{refused}");
    }
}
