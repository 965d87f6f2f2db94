//! Scaffolds: temporary masts for growing far parts of a target in parallel with the rest.
//!
//! A mast is a column next to the target, on a block of the plate. A segment is a path through the
//! target from the mast towards the plate. A mast without segments guides blocks to adjacent
//! growth. When all segments are complete they are handed over block by block. Each block is
//! released and at once captured in place by its final parent. Then the mast is released and the
//! rest grows.
mod dismantling;
mod roles;
mod scaffolding;

pub use dismantling::{Dismantling, HandOver, Mast};
pub use roles::{SitePart, SiteRoles};
pub use scaffolding::{MastSegment, Scaffolding};
