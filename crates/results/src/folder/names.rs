//! Names of the files of a results folder.

/// Name of the manifest, which determines the ensemble.
pub const MANIFEST: &str = "manifest.json";
/// Journal with the finished runs.
pub(crate) const JOURNAL: &str = "journal.jsonl";
/// Checksums of the other files.
pub(crate) const CHECKSUMS_FILE: &str = "checksums.json";
/// Split of an ensemble into shards.
pub(crate) const SHARDS_FILE: &str = "shards.json";
pub(crate) const SHARDS: &str = "shards";
pub(crate) const RECORDINGS: &str = "recordings";
/// Subfolder for checkpoints.
pub const CHECKPOINTS: &str = "checkpoints";
/// Subfolder for corrupted files.
pub const DAMAGED: &str = "damaged";
