//! Turns a shape of a program, or a set of cells, into a checked program that builds it.
mod completion;
mod definition;
mod existing_structure;
mod from_program;
mod larger_scene;
mod loose_parts;
mod no_goal;
mod planning;
mod price;
mod repair;
mod scenes;

pub use completion::untrue_claims;
pub use completion::{Completion, NotCompleted};
pub use definition::Goal;
pub use existing_structure::{ExistingStructure, NoRepair, Repair};
pub use larger_scene::LargerScene;
pub use no_goal::NoGoal;
pub use planning::{Planned, Unplanned};
