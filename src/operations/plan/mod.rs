//! Planning of a program that builds a shape.
mod budget;
mod goal;
mod not_planned;
mod offset;
mod options;
mod pair;
mod race;
mod rest;
mod scene;
mod search;
mod seed_plate;
mod target;

pub use budget::Budget;
pub use not_planned::NotPlanned;
pub use offset::Offset;
pub use options::{LooseParts, PlanOptions, PlanScope, RunEnd};
pub use race::{MAX_RACE, MIN_RACE};
pub use search::{PlanTarget, is_right_at, plan, read};
pub use seed_plate::SeedPlate;
