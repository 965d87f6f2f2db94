//! Compiles syntax trees to dependency graphs, proofs and event tables, without IO, clock or
//! chance.
//!
//! [`check`] runs the stages. It loads and parses files, and expands each assembly ([`plan`]). It
//! checks names, computes cells, and orders events ([`graph`], [`order`]). It proves that free
//! blocks can reach every cell (`reach`), and compares shapes and scene with the structure. A
//! program without errors is lowered to event tables ([`stochc_ir::table`]). Each stage reports its
//! diagnostics and removes the wrong parts, so that the next stage can run.
//!
//! ```
//! use stochc_compiler::{Limits, check};
//!
//! let text = "assembly pair { seed plate 3 x 3 { M at (1, 1) }\nphase grow { M.up -> A   M.up -> B } }";
//! let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
//! let checked = check("pair.sa", &mut reader, Limits::default());
//! let diagnostic = &checked.diagnostics[0];
//! assert_eq!(diagnostic.code.name(), "occupied-cell");
//! assert!(checked.has_errors() && checked.programs[0].tables.is_none());
//! ```
mod block_demand;
mod capacity;
mod checked;
mod declared_scenes;
mod declared_shapes;
pub mod diagnostic;
pub mod emit;
mod executable;
mod expand;
pub mod face_turns;
mod fix;
pub mod graph;
mod layer_picture;
pub mod layout;
mod lint_levels;
mod liveness;
mod load;
mod lower;
mod members;
pub mod model_check;
pub mod names;
pub mod order;
pub mod placed_blocks;
pub mod plan;
mod program;
mod proof;
mod reach;
mod reader;
pub mod scene;
mod scene_check;
mod scenes;
mod shape;
mod short_timeout;
mod source;
pub mod source_map;
mod texts;
mod trial;
mod units;
mod unplanned_bonds;
mod unused;

pub use checked::{Checked, Program};
pub use declared_scenes::{DeclaredScene, declared_scenes};
pub use declared_shapes::{DeclaredShape, DeclaredShapes};
pub use expand::Limits;
pub use fix::{Fixed, fix};
pub use lint_levels::{Allowed, Level, LintLevels};
pub use load::{Module, join as join_import, lone_returns, without_dots};
pub use program::{Stage, check, check_cancellable, check_observed, check_with};
pub use proof::Proof;
pub use reader::Reader;
pub use shape::cells as shape_cells;
pub use short_timeout::MAX_ESTIMATED;
pub use source::{FileId, SourceFile, SourceLocation, Sources};
pub use stochc_grammar::{Cancellation, Cancelled, Span, Symbols};
pub use texts::{check_text, check_texts};
