//! Manifest: everything needed to repeat an ensemble exactly.
mod chosen;
mod ensemble_manifest;
mod ensemble_program;
mod error;
mod limits;
mod stored;
mod varied;

pub use chosen::{ChosenSetting, InvalidSetting};
pub use ensemble_manifest::Manifest;
pub use ensemble_program::{Compiled, EnsembleProgram, Source};
pub use error::ManifestError;
pub use limits::{FORMAT, MAX_RUNS};
pub use varied::{SweepAxes, Varied};
