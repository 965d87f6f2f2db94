//! Search for useful scaffolds: starts from balanced ones and exchanges segments while the estimate
//! improves.
mod balanced;
mod candidates;
mod guides;
mod leaf_peeling;
mod places;
mod trial;

pub(crate) use candidates::{Scaffolded, may_have_scaffolds, scaffolded};
pub use trial::{NoScaffolds, ScaffoldTrial};
