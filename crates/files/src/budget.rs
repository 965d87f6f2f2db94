//! Size limits for reading files from untrusted sources. docs/reference/limits.md lists them.
//!
//! Memory is never allocated by sizes claimed in a file.
use std::io;

const MIB: u64 = 1 << 20;
const GIB: u64 = 1 << 30;

/// Size limit of a kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadBudget {
    /// Limit \[bytes\]. Files must be smaller.
    pub bytes: u64,
    /// Whether the file is JSON, which cannot contain holes.
    pub is_json: bool,
}

const fn json(bytes: u64) -> ReadBudget {
    let is_json = true;
    ReadBudget { bytes, is_json }
}

const fn any(bytes: u64) -> ReadBudget {
    let is_json = false;
    ReadBudget { bytes, is_json }
}

/// Limit for a program. Positions in a program have 32 bits.
pub const PROGRAM: ReadBudget = any(4 * GIB);
/// Limit for a file of compiled programs.
pub(crate) const EXECUTABLE: ReadBudget = json(4 * GIB);
/// Limit for the manifest of an ensemble.
pub const MANIFEST: ReadBudget = json(4 * GIB);
/// Limit for the checksums of a folder.
pub const CHECKSUMS: ReadBudget = json(16 * MIB);
/// Limit for the shards of an ensemble.
pub const SHARDS: ReadBudget = json(MIB);
/// Limit for the rates of a scene.
pub const RATES: ReadBudget = json(16 * MIB);
/// Limit for a table of times to fit.
pub const TIMES: ReadBudget = any(256 * MIB);
/// Limit for the log of an experiment.
pub const LOG: ReadBudget = any(64 * MIB);
/// Limit for the voxels of a target.
pub const VOXELS: ReadBudget = any(256 * MIB);
/// Limit for a page of an earlier report.
pub const PAGE: ReadBudget = any(GIB);
/// Limit for a journal.
pub const JOURNAL: ReadBudget = json(256 * GIB);
/// Limit for a compressed recording.
pub const RECORDING: ReadBudget = any(64 * GIB);

/// Limit for a checkpoint: the state of a running simulation with its recording so far.
pub const CHECKPOINT: ReadBudget = any(128 * GIB);

/// Largest header of a recording \[bytes\].
pub const RECORDING_HEADER: u64 = MIB;
/// Largest part of a recording, compressed or not \[bytes\].
pub const RECORDING_PART: u64 = 256 * MIB;
/// Largest recording that is held in memory as a whole \[bytes\]. The command line never holds
/// whole recordings.
pub const RECORDING_WHOLE: u64 = GIB;
/// Largest event in a recording \[bytes\].
pub const RECORDING_EVENT: usize = 1 << 10;

/// Returns the limit of a run's uncompressed record, for a program with this number of captures
/// \[bytes\].
pub const fn record(captures: u64) -> u64 {
    let most = captures.saturating_mul(1 << 10).saturating_add(64 * MIB);
    if most < GIB { most } else { GIB }
}

impl ReadBudget {
    /// Checks the size of a file.
    ///
    /// # Errors
    ///
    /// If it exceeds the limit.
    pub fn admits(self, bytes: u64) -> io::Result<()> {
        if bytes < self.bytes {
            Ok(())
        } else {
            Err(too_large(&format!("it has {} or more", size(self.bytes))))
        }
    }

    /// Checks a part of a large file for holes, which let small files claim huge sizes.
    ///
    /// # Errors
    ///
    /// If the part has a hole and the kind of file cannot contain holes.
    pub(super) fn accepts(self, part: &[u8]) -> io::Result<()> {
        const PAGE: usize = 1 << 12;
        let is_hole = |page: &[u8]| page.iter().all(|byte| *byte == 0);
        if self.is_json && part.chunks_exact(PAGE).any(is_hole) {
            Err(io::Error::new(io::ErrorKind::InvalidData, "it has a hole"))
        } else {
            Ok(())
        }
    }
}

/// Returns an error for content beyond its limit. `what` names the content.
pub fn too_large(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, what)
}

/// Formats a number of bytes for messages.
pub fn size(bytes: u64) -> String {
    match bytes {
        GIB.. if bytes.is_multiple_of(GIB) => format!("{} GiB", bytes / GIB),
        _ => format!("{} MiB", bytes.div_ceil(MIB)),
    }
}
