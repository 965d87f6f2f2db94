//! Expands patterns, loops and arithmetic.
mod aggregate;
mod arguments;
mod arithmetic;
mod claim;
mod declared_items;
mod duplicate;
mod expander;
mod expansion;
mod handler;
mod limits;
pub(crate) mod members;
mod place;
mod probe;
mod scope;
mod seeds;
mod statement;
mod uncertain;
pub(crate) mod units;
mod unknown;
mod uses;

pub use declared_items::{DeclaredItems, Patterns, Shapes};
pub use duplicate::duplicate;
pub use expander::Declarations;
pub(crate) use expansion::{expand, expand_aggregate, expand_probed};
pub(crate) use limits::MAX_NESTING;
pub use limits::{ExpansionSettings, Limits};
pub(crate) use probe::Probe;
