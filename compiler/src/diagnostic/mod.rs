//! Errors and warnings about programs.
mod change;
mod code;
mod collection;
mod definition;
mod fix;
mod graphical;
mod json;
pub(crate) mod layer_picture;
pub(crate) mod lint_levels;
mod parameter_hint;
mod repeat;
mod row_hint;
mod subjects;
mod syntax;
mod syntax_hints;

pub use change::TextChange;
pub use code::{Code, Severity};
pub(crate) use collection::{fold, has_enough_errors, is_full, is_repeated, report, suggestion};
pub use definition::{Diagnostic, Edit, Fix, Label};
pub(crate) use fix::{LONG, entry, last_named, named, removal};
pub use graphical::{Renderer, visible};
pub use json::{diagnostics_json, program_json};
pub(crate) use parameter_hint::parameter_hint;
pub(crate) use row_hint::row_hint;
pub use subjects::Others;
