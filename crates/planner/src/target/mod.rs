//! The validated structure to build.
pub(crate) mod error;
pub(crate) mod hardware;
pub(crate) mod limits;
pub(crate) mod structure;
pub(crate) mod voxels;
