//! Names of all files of a program, with their declarations and uses.
//!
//! All rules of scope are implemented here. This module decides whether a word means a `let`,
//! counter, parameter, pattern or shape. It also decides whether a parameter is a face. The
//! expansion, the warnings about unused declarations and the editor use it.
//!
//! In this module, names are words: `T[1]` and `T[i + 1]` are uses of the same `T`. Only the
//! expansion can distinguish them ([`crate::sources::source_map`]). Definitions that one name can
//! refer to are merged. This happens if a pattern uses a number that several assemblies define.
mod construction;
mod declared;
mod definition;
mod definitions;
mod index;
mod resolve;

pub use definition::{Definition, NameKind, Occurrence};
pub(crate) use definition::{Keep, Use, ValueKind};
pub use index::Names;
