//! What the files of a results folder are called.

/// What the ensemble depends on.
pub const MANIFEST: &str = "manifest.json";
/// Every finished run.
pub(crate) const JOURNAL: &str = "journal.jsonl";
/// Checksums of the others.
pub(crate) const CHECKSUMS_FILE: &str = "checksums.json";
/// How an ensemble is cut into pieces.
pub(crate) const SHARDS_FILE: &str = "shards.json";
/// The folder within it for pieces.
pub(crate) const SHARDS: &str = "shards";
/// The folder within it for recordings.
pub(crate) const RECORDINGS: &str = "recordings";
/// The folder within it for checkpoints.
pub const CHECKPOINTS: &str = "checkpoints";
/// The folder within it to which damaged files are moved.
pub const DAMAGED: &str = "damaged";
