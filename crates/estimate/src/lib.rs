//! Waiting times of open faces, from their surroundings.
//!
//! A capture is a race of arrivals, each followed by a docking. [`Rates`] are calibrated for a
//! scene. Their law gives the arrival rate and the docking time of a face from the [`Surroundings`]
//! of its cell. [`Wait`] is the resulting distribution.
//!
//! ```
//! use stochc_ir::{Cell, Face};
//! use stochc_estimate::{Neighbourhood, Parameters, around};
//!
//! let wait = |is_full: &dyn Fn(Cell) -> bool| {
//!     let cell = Cell::new(0, 0, 9);
//!     let near = Neighbourhood::new(cell, is_full);
//!     Parameters::TYPICAL.wait(&around(cell, Face::Up, near, |_| None)).mean()
//! };
//! let tower = |cell: Cell| (cell.x, cell.y) == (0, 0) && cell.z < 9;
//! let beside_a_wall = |cell: Cell| tower(cell) || cell.x == 1;
//! assert!(wait(&beside_a_wall) < wait(&tower));
//! ```
mod accessibility;
mod cost;
mod docking_time;
mod first_guess;
mod gap;
mod head_start;
mod interaction;
mod inverse;
mod law;
mod lower_bound;
mod neighbourhood;
mod rates;
mod rivals;
mod surroundings;
mod times;
mod wait;

pub use accessibility::{offsets, sees};
pub use cost::{CaptureCost, Cost, PhaseCost, ProgramParts, estimate, estimate_without_timeouts};
pub use docking_time::STAGES;
pub use first_guess::GUESS_ERROR;
pub use gap::{beside_gap, gap_entrances};
pub use head_start::{HeadStart, HeadStarts, ReleaseNearby, relative};
pub use interaction::Interaction;
pub use law::{Parameter, Parameters, Surroundings};
pub use lower_bound::{LowerBoundReason, LowerBoundReasons};
pub use neighbourhood::{Neighbourhood, SIGHT};
pub use rates::{Coverage, FORMAT, Rates, density_in};
pub use rivals::{Rivalry, Rivals, rivalry, rivals};
pub use surroundings::{around, feature_cells};
pub use times::{Times, quantile};
pub use wait::Wait;

/// Digest of this crate's sources. Two builds with equal digests compute equal results.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
