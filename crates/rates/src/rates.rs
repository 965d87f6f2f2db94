//! What was measured of a scene.
use std::borrow::Cow;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face, strict_json};

use crate::head_start::{HeadStart, HeadStarts};
use crate::law::{Parameters, Surroundings};
use crate::neighbourhood::Neighbourhood;
use crate::rivals::Rivals;
use crate::surroundings::{around, blocked_around};
use crate::wait::Wait;

/// The rates of capture in a scene, with what they were measured from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Rates {
    /// The version of this form.
    pub format: u32,
    /// The scene that they are of.
    pub scene: Scene,
    /// How it was simulated: the model and its steps.
    pub simulated: String,
    /// The seed of the runs.
    pub seed: u64,
    /// The captures observed.
    pub captures: u64,
    /// The numbers of the law.
    pub parameters: Parameters,
    /// Their covariance, row by row.
    pub covariance: Vec<f64>,
    /// Density of the free gas around the plate over the mean of the gas, in layers of one side: the first has the middles of blocks
    /// in the lowest cells.
    pub profile: Vec<f64>,
    /// Blocks that were free at the beginning.
    pub free: u32,
    /// What released blocks do near open faces.
    pub head_starts: Vec<HeadStart>,
    /// Where it was measured.
    pub coverage: Coverage,
}

/// What surroundings were observed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// The highest cell that captured.
    pub highest: i32,
    /// The least part of its sphere of reach that a face had open.
    pub least_open: f64,
    /// The least part of the blocks that was free.
    pub least_free: f64,
}

/// Version of the format of [`Rates`]. No other version is read.
pub const FORMAT: u32 = 1;

/// The place of the parameter for a block ahead.
const AHEAD: usize = 10;

/// The logarithm of a rate's factor from which on a gap hinders nobody: half of the rate.
const SLOWEST_GAP: f64 = -0.7;

/// Rates of built-in scenes, as `stochc calibrate SCENE --out` wrote them.
const BUILT_IN: [&str; 1] = [include_str!("data/hemisphere.rates")];

/// What a [`profile`](Rates::profile) says of a layer of cells; above the last one, what that says.
pub fn density_in(profile: &[f64], layer: i32) -> f64 {
    let layer = usize::try_from(layer - 1).unwrap_or(0);
    profile
        .get(layer)
        .or(profile.last())
        .copied()
        .unwrap_or(1.0)
}

impl Rates {
    /// Those that come with this crate, of a built-in scene; `None`: the scene is another.
    pub fn built_in(scene: &Scene) -> Option<&'static Rates> {
        Rates::shipped().iter().find(|rates| rates.are_of(scene))
    }

    /// Whether blocks are known to [pass gaps](Rates::passes_gaps) in a built-in scene.
    pub fn pass_gaps(scene: &Scene) -> bool {
        Rates::built_in(scene).is_some_and(Rates::passes_gaps)
    }

    /// All that come with this crate, those of the default scene first.
    pub(crate) fn shipped() -> &'static [Rates] {
        static ALL: LazyLock<Vec<Rates>> = LazyLock::new(|| {
            let all = BUILT_IN.iter();
            all.filter_map(|text| Rates::from_text(text).ok()).collect()
        });
        &ALL
    }

    /// Those of a scene among given ones, or those that come with this crate.
    pub fn known<'a>(given: &'a [Rates], scene: &Scene) -> Option<&'a Rates> {
        let given = given.iter().find(|rates| rates.are_of(scene));
        given.or_else(|| Rates::built_in(scene))
    }

    /// Those of a scene that are known, or a [first guess](Rates::first_guess).
    pub fn known_or_guessed<'a>(given: &'a [Rates], scene: &Scene) -> Option<Cow<'a, Rates>> {
        let known = Rates::known(given, scene).map(Cow::Borrowed);
        known.or_else(|| Rates::first_guess(scene).map(Cow::Owned))
    }

    /// Whether they are of this scene.
    pub fn are_of(&self, scene: &Scene) -> bool {
        // What it is called, how many faces a block switches on and what messages do has nothing to do with a wait.
        let mut alike = scene.clone();
        alike.name.clone_from(&self.scene.name);
        alike.block.faces = self.scene.block.faces;
        alike.messages.clone_from(&self.scene.messages);
        self.scene == alike
    }

    /// Whether blocks come into a gap between the face and a block ahead about as fast as elsewhere, beyond doubt: in some scenes they jam there.
    pub fn passes_gaps(&self) -> bool {
        let variance = self.covariance[AHEAD * (Parameters::COUNT + 1)];
        variance > 0.0 && self.parameters.0[AHEAD] - 2.0 * variance.sqrt() > SLOWEST_GAP
    }

    /// Density of the free gas at a layer of cells over the mean; above the measured ones that of the last.
    pub fn density(&self, layer: i32) -> f64 {
        density_in(&self.profile, layer)
    }

    /// What released blocks do in its scene.
    pub fn head_starts(&self) -> HeadStarts<'_> {
        HeadStarts::in_scene(&self.scene, &self.head_starts)
    }

    /// What is around an open face; see [`around`].
    pub fn surroundings(
        &self,
        cell: Cell,
        way: Face,
        near: Neighbourhood,
        open: impl Fn(Cell) -> Option<Face>,
    ) -> Surroundings {
        Surroundings {
            density: self.density(cell.z),
            ..around(cell, way, near, open)
        }
    }

    /// The wait of a face, by how many others wait near it.
    pub fn wait_among(
        &self,
        cell: Cell,
        way: Face,
        near: Neighbourhood,
        rivals: Rivals,
        cold: bool,
    ) -> Wait {
        self.wait(&Surroundings {
            density: self.density(cell.z),
            rivals,
            cold,
            ..blocked_around(cell, way, near)
        })
    }

    /// The wait of a face in such surroundings.
    pub fn wait(&self, surroundings: &Surroundings) -> Wait {
        self.parameters.wait(surroundings)
    }

    /// Returns the blocks of the largest structure that the rates were measured with.
    ///
    /// `None`: they are a first guess.
    pub fn largest_structure(&self) -> Option<u32> {
        let part = 1.0 - self.coverage.least_free;
        let blocks = (part * f64::from(self.free)).round();
        (!self.is_guess()).then_some(blocks as u32)
    }

    /// As a file, a JSON object on lines of its own.
    pub fn to_text(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// From a file.
    ///
    /// # Errors
    /// If it is no such file, or one that makes no sense, in words.
    pub fn from_text(text: &str) -> Result<Rates, String> {
        strict_json(text.as_bytes()).map_err(no_rates)
    }
}

fn no_rates(error: impl std::fmt::Display) -> String {
    format!("it holds no rates as `stochc calibrate` writes them: {error}")
}

// All numbers are finite: `Stored` sees to that.
impl Eq for Rates {}

/// Rates that nobody has looked at yet.
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
}

impl TryFrom<Stored> for Rates {
    type Error = String;

    fn try_from(stored: Stored) -> Result<Rates, String> {
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
        } = stored;
        if format != FORMAT {
            return Err(format!(
                "its format is {format}, and this is {FORMAT}; calibrate again"
            ));
        }
        let parameters = <[f64; Parameters::COUNT]>::try_from(parameters)
            .map_err(|_| "its parameters are of another number")?;
        if covariance.len() != Parameters::COUNT * Parameters::COUNT {
            return Err("its covariance has another size".to_owned());
        }
        // Beyond e^30 no wait has a meaning, and sums overflow.
        if (parameters.iter()).any(|value| !(-30.0..=30.0).contains(value)) {
            return Err("a parameter is out of range".to_owned());
        }
        let is_density = |value: &f64| (0.0..=1e6).contains(value);
        if profile.is_empty() || profile.len() > MAX_LAYERS || !profile.iter().all(is_density) {
            return Err("its profile makes no sense".to_owned());
        }
        let is_start = |start: &HeadStart| {
            (0.0..=1.0).contains(&start.probability) && (0.0..=1e9).contains(&start.ticks)
        };
        if head_starts.len() > MAX_HEAD_STARTS || !head_starts.iter().all(is_start) {
            return Err("its head starts make no sense".to_owned());
        }
        let others = [coverage.least_open, coverage.least_free];
        if covariance
            .iter()
            .chain(&others)
            .any(|value| !value.is_finite())
        {
            return Err("a number is not finite".to_owned());
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
        })
    }
}

/// Layers of a profile, at most.
const MAX_LAYERS: usize = 1000;

/// Squared distances of head starts, at most.
const MAX_HEAD_STARTS: usize = 100;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shipped_is_read_and_comes_out_again() {
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
    fn what_makes_no_sense_is_refused() {
        let sound = Rates::from_text(BUILT_IN[0]).expect("it is sound");
        let spoilt: [fn(&mut Rates); 6] = [
            |rates| rates.format += 1,
            |rates| rates.parameters.0[3] = 1e300,
            |rates| rates.profile.clear(),
            |rates| rates.profile[0] = -1.0,
            |rates| rates.covariance.truncate(7),
            |rates| rates.head_starts[0].probability = 1.5,
        ];
        for spoil in spoilt {
            let mut rates = sound.clone();
            spoil(&mut rates);
            assert!(Rates::from_text(&rates.to_text()).is_err());
        }
    }

    #[test]
    fn a_field_that_means_nothing_is_refused() {
        let text = BUILT_IN[0].replacen("\"seed\"", "\"sead\": 1, \"seed\"", 1);
        let refused = Rates::from_text(&text).expect_err("nobody reads it");
        assert!(refused.contains("`sead`"), "{refused}");
    }
}
