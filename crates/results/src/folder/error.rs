//! Errors of results folders, with remedies.
use std::io;
use std::path::PathBuf;

use stochc_files::shell::file as shell_file;

use crate::journal::JournalError;
use crate::manifest::ManifestError;

/// Error of a results folder.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The folder contains files that are not results of `stochc`.
    #[error("`{0}` contains other files; choose an empty or a new folder")]
    NotResults(PathBuf),
    /// The folder contains runs but no manifest.
    #[error(
        "`{0}` contains runs, but no `manifest.json`, which is needed to read them; restore it, or choose another folder"
    )]
    NoManifest(PathBuf),
    /// The folder does not exist or is empty.
    #[error("`{0}` contains no results; give a folder written by `simulate --out`")]
    Absent(PathBuf),
    /// The path is a file, not a folder.
    #[error("`{0}` is a file; choose another name for the folder")]
    NotAFolder(PathBuf),
    /// The manifest is corrupted, invalid, or has another format.
    #[error(
        "cannot read `manifest.json` in `{path}`: {reason}; \
         choose another folder, or read this one with the version that made it"
    )]
    Unreadable {
        /// Results folder.
        path: PathBuf,
        /// Reason why the manifest is invalid.
        reason: ManifestError,
    },
    /// The manifest does not match its checksum.
    #[error(
        "`manifest.json` in `{path}` is damaged, or has been changed by hand: its checksum differs; \
         `stochc fsck {}` lists the corrupted files, and with `--repair` repairs the folder",
        shell_file(&.path.to_string_lossy())
    )]
    Corrupted {
        /// Results folder.
        path: PathBuf,
    },
    /// The folder contains another ensemble.
    #[error(
        "`{path}` contains another ensemble: {}; choose another folder, because results are never overwritten",
        .differences.join(", ")
    )]
    Another {
        /// Results folder.
        path: PathBuf,
        /// Description of each difference.
        differences: Vec<String>,
    },
    /// The folder contains the same ensemble, which is unfinished, and resuming was not requested.
    #[error("`{path}` contains {done} of the {total} runs of this ensemble; resume it with `stochc resume {}`", shell_file(&.path.to_string_lossy()))]
    Unfinished {
        /// Results folder.
        path: PathBuf,
        /// Number of finished runs.
        done: u64,
        /// Number of requested runs.
        total: u64,
    },
    /// Another build made the runs in the folder.
    #[error(
        "`{path}`: {reason}; go on with the `stochc` that made them, or choose another folder; `--mixed-builds` \
         goes on if this one makes a run of them again as it was"
    )]
    OtherBuild {
        /// Results folder.
        path: PathBuf,
        /// Description of the builds.
        reason: String,
    },
    /// Another build made the shards in the folder.
    #[error(
        "`{path}`: {reason}; run its shards with the `stochc` that split it, or split another folder with this one"
    )]
    OtherBuildOfShards {
        /// Results folder.
        path: PathBuf,
        /// Description of the builds.
        reason: String,
    },
    /// The ensemble of the folder is split into shards.
    #[error(
        "`{path}` has shards that are not merged; `stochc shard status {folder}` lists them, and \
         `stochc shard merge {folder}` merges them",
        folder = shell_file(&.path.to_string_lossy())
    )]
    Split {
        /// Results folder.
        path: PathBuf,
    },
    /// `shards.json` is corrupted beyond repair.
    #[error(
        "`shards.json` in `{0}` is damaged beyond repair; move it away: `stochc simulate` with the programs and options of \
         before, its `--shards` too, writes it anew and keeps the shards"
    )]
    LostSplit(PathBuf),
    /// The manifest is corrupted beyond repair.
    #[error(
        "`manifest.json` in `{0}` is damaged beyond repair, and without it nobody can go on with its runs; put a copy of \
         it back, or make the runs again in another folder. Tables that are sound can be read as they are"
    )]
    LostManifest(PathBuf),
    /// The folder contains more runs of the same ensemble than requested.
    #[error(
        "`{path}` is an ensemble of {there} runs of each program, more than the {requested} asked for; \
         ask for {there}, or choose another folder"
    )]
    MoreRuns {
        /// Results folder.
        path: PathBuf,
        /// Number of runs of each program in the folder's manifest.
        there: u64,
        /// Requested number of runs of each program.
        requested: u64,
    },
    /// Another process is writing to the folder.
    #[error("another process is writing to `{0}`; wait for its end, or choose another folder")]
    Locked(PathBuf),
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// Error of the file system, with its path.
    #[error("cannot use `{path}`: {source}")]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

impl FolderError {
    /// Returns a function that adds a path to an error of the system.
    pub(crate) fn at(path: impl Into<PathBuf>) -> impl Fn(io::Error) -> FolderError {
        let path = path.into();
        move |source| FolderError::Io {
            path: path.clone(),
            source,
        }
    }
}
