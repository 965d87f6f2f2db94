//! What was measured of a scene.
use serde::{Deserialize, Serialize};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face, sha256};

use crate::law::{Parameters, Surroundings};
use crate::surroundings::around;
use crate::wait::Wait;

/// The rates of capture in a scene, with what they were measured from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Rates {
    /// The version of this form.
    pub format: u32,
    /// Which scene: [`scene_digest`].
    pub scene: String,
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

/// What a block does that is released near an open face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeadStart {
    /// The squared distance from its cell to the open one, in sides.
    pub squared_distance: u32,
    /// The probability that it docks there, if no other does before.
    pub probability: f64,
    /// The mean time in which it does \[tick\].
    pub ticks: f64,
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

/// The version of the form of [`Rates`].
pub const FORMAT: u32 = 1;

/// Ticks after which a released block is one like any other.
pub const FORGOTTEN: u64 = 150;

/// The name of a scene's numbers: two scenes with one digest behave the same.
pub fn scene_digest(scene: &Scene) -> String {
    sha256(scene)
}

impl Rates {
    /// Whether they are of this scene.
    pub fn are_of(&self, scene: &Scene) -> bool {
        self.scene == scene_digest(scene)
    }

    /// Density of the free gas at a layer of cells over the mean; above the measured ones that of the last.
    pub fn density(&self, layer: i32) -> f64 {
        let layer = usize::try_from(layer - 1).unwrap_or(0);
        let there = self.profile.get(layer).or(self.profile.last());
        there.copied().unwrap_or(1.0)
    }

    /// What is around an open face; see [`around`].
    pub fn surroundings(
        &self,
        cell: Cell,
        way: Face,
        is_full: impl Fn(Cell) -> bool,
        is_open: impl Fn(Cell) -> bool,
    ) -> Surroundings {
        Surroundings {
            density: self.density(cell.z),
            ..around(cell, way, is_full, is_open)
        }
    }

    /// The wait of a face in such surroundings.
    pub fn wait(&self, surroundings: &Surroundings) -> Wait {
        self.parameters.wait(surroundings)
    }

    /// The chance of a released block to dock at a squared distance.
    pub fn head_start(&self, squared_distance: u32) -> Option<HeadStart> {
        (self.head_starts.iter())
            .find(|start| start.squared_distance == squared_distance)
            .copied()
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
        serde_json::from_str(text).map_err(|error| error.to_string())
    }
}

// All numbers are finite: `Stored` sees to that.
impl Eq for Rates {}

/// Rates that nobody has looked at yet.
#[derive(Deserialize)]
struct Stored {
    format: u32,
    scene: String,
    simulated: String,
    seed: u64,
    captures: u64,
    parameters: Parameters,
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
        if covariance.len() != Parameters::COUNT * Parameters::COUNT {
            return Err("its covariance has another size".to_owned());
        }
        // Beyond e^30 no wait has a meaning, and sums overflow.
        if parameters
            .0
            .iter()
            .any(|value| !(-30.0..=30.0).contains(value))
        {
            return Err("a parameter is out of range".to_owned());
        }
        let is_density = |value: &f64| (0.0..=1e6).contains(value);
        if profile.is_empty() || profile.len() > MOST_LAYERS || !profile.iter().all(is_density) {
            return Err("its profile makes no sense".to_owned());
        }
        let is_start = |start: &HeadStart| {
            (0.0..=1.0).contains(&start.probability) && (0.0..=1e9).contains(&start.ticks)
        };
        if head_starts.len() > MOST_HEAD_STARTS || !head_starts.iter().all(is_start) {
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
        })
    }
}

/// Layers of a profile, at most.
const MOST_LAYERS: usize = 1000;

/// Squared distances of head starts, at most.
const MOST_HEAD_STARTS: usize = 100;
