//! Verification and repair of results folders.
mod file_integrity;
mod verify;

pub use file_integrity::{FileIntegrity, Integrity};
pub use verify::{repair, verify};
