//! How much is read of files that somebody else may have made: the one table of it, told in docs/limits.md.
//!
//! What a file claims to hold never decides how much memory is asked for.
use std::io;

const MIB: u64 = 1 << 20;
const GIB: u64 = 1 << 30;

/// How much is read of a kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadBudget {
    /// Its bytes, fewer than which it has to have.
    pub bytes: u64,
    /// Whether it is JSON, in which there are no holes.
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

/// A program: places in it are counted with 32 bits.
pub const PROGRAM: ReadBudget = any(4 * GIB);
/// A file of compiled programs.
pub const EXECUTABLE: ReadBudget = json(4 * GIB);
/// The manifest of an ensemble.
pub const MANIFEST: ReadBudget = json(4 * GIB);
/// The checksums of a folder.
pub const CHECKSUMS: ReadBudget = json(16 * MIB);
/// How an ensemble is cut into pieces.
pub const SHARDS: ReadBudget = json(MIB);
/// The rates of a scene.
pub const RATES: ReadBudget = json(16 * MIB);
/// A table of times to fit to.
pub const TIMES: ReadBudget = any(256 * MIB);
/// Voxels to be planned.
pub const VOXELS: ReadBudget = any(256 * MIB);
/// The page of an earlier report.
pub const PAGE: ReadBudget = any(GIB);
/// A journal.
pub const JOURNAL: ReadBudget = json(256 * GIB);
/// A recording, packed.
pub const RECORDING: ReadBudget = any(64 * GIB);

/// The state of a run under way, with its recording so far.
pub const CHECKPOINT: ReadBudget = any(128 * GIB);

/// Bytes of the header of a recording, at most.
pub const RECORDING_HEADER: u64 = MIB;
/// Bytes of one part of a recording, packed or unpacked, at most.
pub const RECORDING_PART: u64 = 256 * MIB;
/// Bytes of a recording that is held in memory as a whole, at most; the command never does so.
pub const RECORDING_WHOLE: u64 = GIB;
/// Bytes of an event in a recording, at most.
pub const RECORDING_EVENT: usize = 1 << 10;

/// Bytes of the record of a run in a journal or a recording, unpacked, at most: of a program with so many captures.
pub const fn record(captures: u64) -> u64 {
    let most = captures.saturating_mul(1 << 10).saturating_add(64 * MIB);
    if most < GIB { most } else { GIB }
}

impl ReadBudget {
    /// Refuses a file of so many bytes.
    ///
    /// # Errors
    /// Where it has too many.
    pub fn admits(self, bytes: u64) -> io::Result<()> {
        if bytes < self.bytes {
            Ok(())
        } else {
            Err(too_large(&format!("it has {} or more", size(self.bytes))))
        }
    }

    /// Refuses a part of a large file with a hole, which costs whoever has made it nothing.
    ///
    /// # Errors
    /// Where there is one that no such file has.
    pub(super) fn accepts(self, part: &[u8]) -> io::Result<()> {
        /// A page of a disk.
        const PAGE: usize = 1 << 12;
        let is_hole = |page: &[u8]| page.iter().all(|byte| *byte == 0);
        if self.is_json && part.chunks_exact(PAGE).any(is_hole) {
            Err(io::Error::new(io::ErrorKind::InvalidData, "it has a hole"))
        } else {
            Ok(())
        }
    }
}

/// An error about something that is larger than is allowed.
pub fn too_large(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, what)
}

/// A number of bytes, as messages tell it.
pub fn size(bytes: u64) -> String {
    match bytes {
        GIB.. if bytes.is_multiple_of(GIB) => format!("{} GiB", bytes / GIB),
        _ => format!("{} MiB", bytes.div_ceil(MIB)),
    }
}
