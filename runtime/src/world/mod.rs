//! How free blocks move in each model, and how the structure acts on them.
mod block_units;
mod blocks;
mod bonding;
mod cell_centres;
mod delegate;
mod error;
mod external_forces;
mod free_bonds;
mod grid;
mod groups;
mod initial_state;
mod interface;
mod lattice;
mod motion_limits;
mod parameters;
mod ranked;
#[cfg(feature = "rapier")]
pub mod rapier;
pub mod rate;
mod real;
pub mod rigid;
pub mod rotation;
pub mod shuffle;
mod step_limit;
mod stepper;
mod unit_cube;
pub mod view;
mod wall_force;

pub use blocks::BodyState;
pub use error::SceneError;
pub use interface::{Fault, FreeBond, SpatialWorld, World};
pub use stochc_control::{BlockFace, Body, Docking};
