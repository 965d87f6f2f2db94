//! Compiled programs as plain values, without source and physics.
//!
//! The compiler makes [event tables](table) and reads [scenes](scene). The runtime runs tables in
//! scenes and returns [records](record). This crate defines all three, so that compiler and runtime
//! are independent of each other.
mod cells;
pub mod claim;
mod draw;
pub mod emit;
mod executable;
pub mod graph;
mod json;
pub mod record;
pub mod scene;
pub mod state;
pub mod structure;
pub mod table;

pub use cells::cell::{Cell, offsets_within};
pub use cells::cell_bounds::CellBounds;
pub use cells::face::Face;
pub use draw::Draw;
pub use executable::{Executable, ExecutableError, FORMAT, InvalidExecutable, JamRisk, sha256};
pub use json::strict::{StrictJsonError, strict_json};
pub use json::value::Json;

/// Digest of this crate's sources. Two builds with equal digests compute equal results.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
