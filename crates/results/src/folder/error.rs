//! Why a results folder is not used, and the way out.
use std::io;
use std::path::PathBuf;

use stochc_files::shell::file as shell_file;

use crate::journal::JournalError;

/// Why a folder was refused.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// Somebody's other files.
    #[error("`{0}` holds other files than results; choose an empty or a new folder")]
    NotResults(PathBuf),
    /// There are runs, and nothing that says of what.
    #[error(
        "`{0}` holds runs, but its `manifest.json` is gone, without which nobody can read them; put it back, or choose another folder"
    )]
    NoManifest(PathBuf),
    /// It is to be read, and holds no results.
    #[error("`{0}` holds no results; give a folder that `simulate --out` has written")]
    Absent(PathBuf),
    /// A file of that name stands in the way.
    #[error("`{0}` is a file; choose another name for the folder")]
    NotAFolder(PathBuf),
    /// The manifest is damaged, of another format, or no manifest at all.
    #[error(
        "cannot read `manifest.json` in `{path}`: {reason}; \
         choose another folder, or read this one with the version that made it"
    )]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// What is wrong with the manifest.
        reason: String,
    },
    /// The manifest is not what was written.
    #[error(
        "`manifest.json` in `{path}` is damaged, or has been changed by hand: its checksum differs; \
         `stochc fsck {}` lists the corrupted files, and with `--repair` repairs the folder",
        shell_file(&.path.to_string_lossy())
    )]
    Damaged {
        /// The folder.
        path: PathBuf,
    },
    /// The results of something else.
    #[error(
        "`{path}` holds another ensemble: {}; choose another folder, results are never overwritten",
        .differences.join(", ")
    )]
    Another {
        /// The folder.
        path: PathBuf,
        /// What is not the same, in words.
        differences: Vec<String>,
    },
    /// The same ensemble, not finished, and nobody asked to resume.
    #[error("`{path}` holds {done} of the {total} runs of this ensemble; resume it: stochc resume {}", shell_file(&.path.to_string_lossy()))]
    Unfinished {
        /// The folder.
        path: PathBuf,
        /// Runs that are done.
        done: u64,
        /// Runs that are asked for.
        total: u64,
    },
    /// Its runs are those of another build.
    #[error(
        "`{path}`: {reason}; go on with the `stochc` that made them, or choose another folder; `--mixed-builds` \
         goes on if this one makes a run of them again as it was"
    )]
    OtherBuild {
        /// The folder.
        path: PathBuf,
        /// Which, in words.
        reason: String,
    },
    /// Its pieces are those of another build.
    #[error(
        "`{path}`: {reason}; make its pieces with the `stochc` that has cut it, or cut another folder with this one"
    )]
    OtherBuildOfPieces {
        /// The folder.
        path: PathBuf,
        /// Which, in words.
        reason: String,
    },
    /// Its runs are in pieces.
    #[error(
        "`{path}` has shards that are not merged; `stochc shard status {folder}` lists them, and \
         `stochc shard merge {folder}` merges them",
        folder = shell_file(&.path.to_string_lossy())
    )]
    Cut {
        /// The folder.
        path: PathBuf,
    },
    /// How its runs are cut into pieces cannot be told any more.
    #[error(
        "`shards.json` in `{0}` is damaged beyond repair; move it away: `stochc simulate` with the programs and options of \
         before, its `--shards` too, writes it anew and keeps the pieces"
    )]
    LostCut(PathBuf),
    /// The manifest is damaged beyond repair.
    #[error(
        "`manifest.json` in `{0}` is damaged beyond repair, and without it nobody can go on with its runs; put a copy of \
         it back, or make the runs again in another folder. Tables that are sound can be read as they are"
    )]
    LostManifest(PathBuf),
    /// The same ensemble, with more runs than asked for.
    #[error(
        "`{path}` is an ensemble of {there} runs of each program, more than the {asked} asked for; \
         ask for {there}, or choose another folder"
    )]
    MoreRuns {
        /// The folder.
        path: PathBuf,
        /// Runs of each program in the folder's manifest.
        there: u64,
        /// Runs of each program that were asked for.
        asked: u64,
    },
    /// Another process writes to it.
    #[error("another process is writing to `{0}`; wait for its end, or choose another folder")]
    Locked(PathBuf),
    /// The journal is not of this ensemble or cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The file system refused.
    #[error("cannot use `{path}`: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl FolderError {
    /// What the system says of a file or a folder.
    pub(crate) fn at(path: impl Into<PathBuf>) -> impl Fn(io::Error) -> FolderError {
        let path = path.into();
        move |source| FolderError::Io {
            path: path.clone(),
            source,
        }
    }
}
