//! What a program is once it is compiled, as plain values: no text, no physics.
//!
//! The compiler makes [event tables](table) and reads [scenes](scene); the runtime runs the one in the other and leaves
//! [records](record). All three are here, so that neither needs to know the other.
mod cell;
mod cell_bounds;
mod draw;
pub mod emit;
mod executable;
mod face;
pub mod graph;
mod invisible;
mod json;
pub mod palette;
mod phrases;
mod plate;
pub mod record;
pub mod scene;
pub mod state;
mod strict_json;
pub mod structure;
pub mod suggest;
pub mod table;

pub use cell::{Cell, offsets_within};
pub use cell_bounds::CellBounds;
pub use draw::Draw;
pub use executable::{Executable, ExecutableError, FORMAT, JamRisk, sha256};
pub use face::Face;
pub use invisible::{is_invisible, visible, visible_lines};
pub use json::Json;
pub use phrases::{counted, listed, series};
pub use strict_json::{StrictJsonError, strict_json};

/// A digest of this crate's sources: two builds with one digest compute the same.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
