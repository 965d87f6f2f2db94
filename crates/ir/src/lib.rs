//! Compiled programs as plain values, without source and physics.
//!
//! The compiler makes [event tables](table) and reads [scenes](scene). The runtime runs tables in
//! scenes and returns [records](record). This crate defines all three, so that compiler and runtime
//! are independent of each other.
mod cell;
mod cell_bounds;
mod draw;
pub mod emit;
mod executable;
mod face;
pub mod graph;
mod json;
mod plate;
pub mod record;
pub mod scene;
pub mod state;
mod strict_json;
pub mod structure;
pub mod table;

pub use cell::{Cell, offsets_within};
pub use cell_bounds::CellBounds;
pub use draw::Draw;
pub use executable::{Executable, ExecutableError, FORMAT, JamRisk, sha256};
pub use face::Face;
pub use json::Json;
pub use strict_json::{StrictJsonError, strict_json};

/// Digest of this crate's sources. Two builds with equal digests compute equal results.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
