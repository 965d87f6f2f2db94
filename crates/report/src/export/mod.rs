//! The ways of all blocks in a run, for other programs.
//!
//! Each format is an [`Observer`](stochc_runtime::observe::Observer) of the run itself, so that
//! numbers come out as they are computed and not as a recording rounds them.
mod gltf;
mod trajectories;

pub use gltf::{GLTF_MARK, Gltf, GltfError};
pub use trajectories::{TRAJECTORIES_MARK, Trajectories};
