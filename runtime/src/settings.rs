//! How a run is computed: the model and its accuracy, which are never the scene's.
use serde::{Deserialize, Serialize};

/// Everything about a run that is neither in the program nor in the scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// What moves the blocks.
    pub model: Model,
    /// Steps of the engine per tick, at least 1; default 1, with which `hemisphere` is calibrated.
    ///
    /// More resolve contacts and docking better and cost proportionally more. They are not a
    /// refinement of the same numbers: with stiffer contacts, blocks wedge more often.
    pub substeps: u32,
    /// `num_solver_iterations` of Rapier: internal steps of the contact solver per substep, at
    /// least 1; default 4, the engine's own.
    ///
    /// Fewer are cheaper and leave deeper overlaps, more are stiffer. The number changes results
    /// by tens of percent, so it is a part of what a scene was calibrated with.
    pub solver_iterations: u32,
    /// Ticks after which a run is given up; `None`, the default: never.
    pub max_ticks: Option<u64>,
}

/// What moves the blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Full rigid bodies by the engine Rapier, in single precision: the reference.
    Rapier,
    /// No physics: one random capture a tick. It tests protocols; its times mean nothing.
    Shuffle,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            model: Model::Rapier,
            substeps: 1,
            solver_iterations: 4,
            max_ticks: None,
        }
    }
}
