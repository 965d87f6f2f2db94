//! Plans the captures that build a shape, and writes them as a program. Pure: no I/O, no clock, and
//! random numbers only from a seed.
//!
//! [`Target`] is the validated structure to build. [`plan`] disassembles it (`disassembly`), which
//! gives an order with an access path for every cell. It then finds the paths that must stay open
//! and makes obstructing blocks wait (`corridor`). It chooses the next face to open (`scheduling`)
//! and compares alternatives by sampled completion times (`search`). [`program`] writes the result.
//!
//! ```
//! use stochc_ir::table::Plate;
//! use stochc_planner::{Target, layers};
//!
//! let cells = layers("##\n##").expect("layers of text");
//! let plate = Plate { width: 2, depth: 2 };
//! assert!(Target::new(cells.clone(), plate.clone(), None, /* free */ 300).is_ok());
//! // Blocks without support.
//! let floating = cells.into_iter().map(|cell| stochc_ir::Cell::new(cell.x, cell.y, cell.z + 1));
//! assert!(Target::new(floating.collect(), plate, None, 300).is_err());
//! ```
mod disassembly;
mod emit;
mod goal;
mod plan;
mod scaffold;
mod scaffold_search;
mod scheduling;
mod search;
mod space;
mod target;
mod timing;

pub use emit::{Naming, PLANNED_MARK, continuation, declaration, draft, program};
pub use goal::{
    Completion, ExistingStructure, Goal, LargerScene, NoGoal, NoRepair, NotCompleted, Planned,
    Repair, Unplanned, untrue_claims,
};
pub use plan::baseline::Baseline;
pub use plan::build_plan::{Alternative, BuildPlan, Plans, RaceTimes, plan};
pub use plan::capture::Capture;
pub use plan::explanation::{explanation, race_to_text};
pub use scaffold::{Dismantling, HandOver, Mast};
pub use scaffold_search::{NoScaffolds, ScaffoldTrial};
pub use search::PlanSearch;
pub use target::error::{LoosePart, TargetError, listed_cells};
pub use target::hardware::Hardware;
pub use target::limits::{FARTHEST, MAX_CELLS};
pub use target::structure::{ExistingBlock, Target};
pub use target::voxels::{UnreadableVoxels, VoxelScene, layers, magica_voxel};
pub use timing::makespan::{Objective, PlanEstimate};
pub use timing::precedence::Why;
pub use timing::rate_law::{CellState, Moment, RateLaw};
