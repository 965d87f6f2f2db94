//! Cells, sites and the space around them.
pub(crate) mod corridor;
pub(crate) mod crowding;
pub(crate) mod free_space;
pub(crate) mod grid;
pub(crate) mod sites;
pub(crate) mod support;
