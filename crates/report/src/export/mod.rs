//! Export of the motion of all blocks in a run.
//!
//! Each format is an [`Observer`](stochc_runtime::observe::Observer) of the run. It receives the
//! positions without the rounding of a recording.
mod gltf;
mod trajectories;

pub use gltf::{GLTF_MARK, Gltf, GltfError};
pub use trajectories::{TRAJECTORIES_MARK, Trajectories};
