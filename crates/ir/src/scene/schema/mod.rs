//! Schema of scenes: keywords, parameters, laws and conditions as data.
//!
//! Reader, writer, descriptions, sweeps, editors and the language reference all follow these
//! tables. None of them has code for a single term.
mod clauses;
mod entry;
mod equations;
mod lookup;
mod number;
pub mod numbers;
mod reference;
mod requirements;

pub(super) use clauses::TILT;
pub use clauses::{CLAUSES, unspecified};
pub use entry::{Absent, Either, FieldAlternative, FieldGroup, SchemaEntry, SchemaPart};
pub use equations::{Derived, Equation, EquationSymbol};
pub use lookup::{is_word, numbers};
pub use number::{Range, SchemaNumber};
pub use requirements::{REQUIREMENTS, Requirement};
