//! Compiles syntax trees to dependency graphs, proofs and event tables, without IO, clock or
//! randomness.
//!
//! [`check`] runs the stages. It loads and parses files, and expands each assembly ([`expanded`]). It
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
mod blocks;
mod check;
mod dependencies;
pub mod diagnostic;
pub mod emit;
mod expand;
pub mod expanded;
pub mod names;
mod reach;
pub mod scene;
mod shapes;
mod sources;

pub use blocks::bond_loads::PhaseLoad;
pub use check::assembly::Stage;
pub use check::changes::{Changes, ParameterChange};
pub use check::checked::{Checked, Program};
pub use check::fix::{Fixed, fix};
pub use check::model_check;
pub use check::program::{check, check_cancellable, check_changed, check_observed, check_with};
pub use check::proof::Proof;
pub use check::short_timeout::MAX_ESTIMATED;
pub use check::texts::{check_text, check_texts};
pub use dependencies::face_turns;
pub use dependencies::graph;
pub use dependencies::order;
pub use diagnostic::lint_levels::{Allowed, Level, LintLevels};
pub use expand::Limits;
pub use scene::declared_scenes::{DeclaredScene, declared_scenes};
pub use shapes::declared_shapes::{DeclaredShape, DeclaredShapes};
pub use shapes::layout;
pub use shapes::placed_blocks;
pub use shapes::shape::cells as shape_cells;
pub use sources::load::{Module, join as join_import, lone_returns, without_dots};
pub use sources::reader::Reader;
pub use sources::source::{FileId, SourceFile, SourceLocation, Sources};
pub use sources::source_map;
pub use stochc_grammar::{Cancellation, Cancelled, Span, Symbols};
