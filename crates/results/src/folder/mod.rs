//! The results folder of an ensemble.
mod checksums;
mod error;
mod names;
mod results_folder;
pub(crate) mod slurm_folder;

pub(crate) use checksums::FolderChecksums;
pub use error::FolderError;
pub use names::{CHECKPOINTS, DAMAGED, MANIFEST};
pub(crate) use names::{CHECKSUMS_FILE, JOURNAL, RECORDINGS, SHARDS, SHARDS_FILE};
pub use results_folder::{
    Contents, Folder, FolderState, Further, FurtherFiles, Resume, check_manifest, is_remnant,
    survey, write_tables,
};
pub(crate) use results_folder::{
    lock, replace, retain_valid_lines, without_manifest, write_checksums, write_manifest,
};
