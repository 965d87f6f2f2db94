//! From a shape to an order of captures that builds it, and to the program of that order. Pure: no IO, clock or chance but
//! that of a seed.
//!
//! [`Target`] is what is to be built, and says what is wrong with it. [`plan`] takes it apart (`disassembly`), which gives an
//! order with a way in for every cell; looks for the ways that have to stay open, and lets the blocks that would close
//! them wait (`corridor`); decides which face opens next (`scheduling`); and tries other decisions on sampled times to
//! completion (`search`). [`program`] writes it down.
//!
//! ```
//! use stochc_ir::table::Plate;
//! use stochc_planner::{Target, layers};
//!
//! let cells = layers("##\n##").expect("layers of text");
//! let plate = Plate { width: 2, depth: 2 };
//! assert!(Target::new(cells.clone(), plate.clone(), None, /* free */ 300).is_ok());
//! // Blocks that nothing holds.
//! let floating = cells.into_iter().map(|cell| stochc_ir::Cell::new(cell.x, cell.y, cell.z + 1));
//! assert!(Target::new(floating.collect(), plate, None, 300).is_err());
//! ```
mod baseline;
mod capture;
mod corridor;
mod crowding;
mod disassembly;
mod emit;
mod explanation;
mod free_space;
mod grid;
mod hardware;
mod limits;
mod makespan;
mod plan;
mod precedence;
mod rate_law;
mod scaffold;
mod scaffold_search;
mod schedule;
mod scheduling;
mod search;
mod sites;
mod support;
mod target;
mod target_error;
mod voxels;

pub use baseline::Baseline;
pub use capture::Capture;
pub use emit::{Naming, PLANNED_MARK, continuation, declaration, draft, program};
pub use explanation::{explanation, race_to_text};
pub use hardware::Hardware;
pub use limits::{FARTHEST, MAX_CELLS};
pub use makespan::{Objective, PlanEstimate};
pub use plan::{Alternative, BuildPlan, Plans, RaceTimes, baseline_plans, plan};
pub use precedence::Why;
pub use rate_law::{CellState, Moment, RateLaw};
pub use scaffold::{Dismantling, HandOver, Mast};
pub use scaffold_search::{NoScaffolds, ScaffoldTrial};
pub use search::PlanSearch;
pub use target::{ExistingBlock, Target};
pub use target_error::{LoosePart, TargetError, listed_cells};
pub use voxels::{UnreadableVoxels, VoxelScene, layers, magica_voxel};
