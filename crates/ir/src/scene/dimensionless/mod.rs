//! Dimensionless numbers of a scene, which are the same at every scale.
//!
//! Some also limit the time step. docs/concepts/time-steps.md lists them.
mod all;
mod block_units;
mod gas;
mod number;
mod settling;
mod softness;
mod speed;
mod suction;

pub(super) use all::DRAG_SYMBOL;
pub use all::dimensionless_numbers;
pub use block_units::BlockUnits;
pub use gas::Gas;
pub use number::{AdvisedRange, DimensionlessNumber, ExpectedRange, ResolutionLimit};
pub use settling::Settling;
pub(super) use speed::rms_of_range;
pub(crate) use speed::turn_in_steps;
pub use speed::{Speed, SpeedFrom, carried, kick, speed};
