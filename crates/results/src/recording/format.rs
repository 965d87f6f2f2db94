//! File format: magic bytes, version, header, and sections that can be skipped.
use std::io::{self, Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use serde::{Deserialize, Serialize};
use stochc_files::budget::{RECORDING_HEADER, RECORDING_WHOLE, size};
use stochc_files::checksum::crc32;

/// Version of the format of recordings. Other versions are rejected.
pub const VERSION: u32 = 1;

/// Magic bytes at the start of every recording.
pub(super) const MARK: [u8; 8] = *b"STOCHREC";

/// Tag of a section with the positions of all blocks at several ticks.
pub(super) const POSES: [u8; 4] = *b"POSE";
/// Tag of a section with the events of the same period.
pub(super) const EVENTS: [u8; 4] = *b"EVNT";
/// Tag of the last section, with the record of the run.
pub(super) const DONE: [u8; 4] = *b"DONE";

/// Header of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecordingHeader {
    /// Version of `stochc` that made the recording.
    pub stochc: String,
    /// Identity of the ensemble's manifest.
    pub ensemble: String,
    /// Index of the program in the manifest.
    pub program: usize,
    /// Number of the run, from 0.
    pub run: u64,
    /// Number of ticks between two frames. Ticks with structural changes also have a frame.
    pub every: u32,
    /// Number of initially free blocks.
    pub bodies: u32,
}

/// Error of a recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file does not begin with the magic bytes.
    #[error("it is not a recording of a run")]
    Foreign,
    /// The version of the format is unknown.
    #[error("its format is version {0}, and this `stochc` reads version {VERSION}")]
    Version(u32),
    /// The recording is truncated. Contains its last complete tick if known.
    #[error("it is truncated{}", .0.map_or(String::new(), |tick| format!(" after tick {tick}")))]
    CutShort(Option<u64>),
    /// A part of the recording is invalid.
    #[error("it is damaged: {0}")]
    Corrupted(&'static str),
    /// The recording is too large to be held in memory.
    #[error("it has {} or more, unpacked", size(RECORDING_WHOLE))]
    TooLarge,
    /// The recording could not be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Returns whether a file begins like a recording of any version.
///
/// # Errors
///
/// Errors of the file.
pub fn is_file(file: &mut std::fs::File) -> io::Result<bool> {
    let mut mark = [0; 8];
    Ok(fill(file, &mut mark)? == mark.len() && mark == MARK)
}

/// Writes magic bytes, version and header of a recording.
pub(super) fn write_header(out: &mut impl Write, header: &RecordingHeader) -> io::Result<()> {
    let json = serde_json::to_vec(header)?;
    let length = json.len() as u32;
    let numbers = [VERSION.to_le_bytes(), length.to_le_bytes()].concat();
    write_sealed(out, &[&MARK, &numbers, &json])
}

/// Writes bytes and then their checksum.
fn write_sealed(out: &mut impl Write, parts: &[&[u8]]) -> io::Result<()> {
    let part = parts.concat();
    out.write_all(&part)?;
    out.write_all(&crc32(&part).to_le_bytes())
}

/// Reader that computes the checksum of the part that it reads.
struct ChecksummedSection<R> {
    from: R,
    bytes: Vec<u8>,
}

impl<R: Read> ChecksummedSection<R> {
    /// Reads the next `count` bytes, or fewer at the end of the file.
    fn take(&mut self, count: u64) -> io::Result<&[u8]> {
        let at = self.bytes.len();
        self.from
            .by_ref()
            .take(count)
            .read_to_end(&mut self.bytes)?;
        Ok(&self.bytes[at..])
    }

    /// Reads the next 4 bytes as an integer. Returns `None` at the end of the file.
    fn number(&mut self) -> io::Result<Option<u32>> {
        Ok(self.take(4)?.try_into().ok().map(u32::from_le_bytes))
    }

    /// Reads the checksum that follows the bytes read so far, and returns whether it is correct.
    /// Returns `None` at the end of the file.
    fn is_valid(&mut self) -> io::Result<Option<bool>> {
        let crc = crc32(&self.bytes);
        Ok(self.number()?.map(|stored| stored == crc))
    }
}

/// Reads magic bytes, version and header of a recording.
pub(super) fn read_header(from: &mut impl Read) -> Result<RecordingHeader, RecordingError> {
    let short = || RecordingError::CutShort(None);
    let mut part = ChecksummedSection {
        from,
        bytes: Vec::new(),
    };
    let mark = part.take(8)?;
    if mark.is_empty() || !MARK.starts_with(mark) {
        return Err(RecordingError::Foreign);
    }
    let version = part.number()?.ok_or_else(short)?;
    if version != VERSION {
        return Err(RecordingError::Version(version));
    }
    let length = part.number()?.ok_or_else(short)?;
    if u64::from(length) > RECORDING_HEADER {
        return Err(RecordingError::Corrupted("its header"));
    }
    let json = part.take(length.into())?;
    if json.len() < length as usize {
        return Err(short());
    }
    let header = serde_json::from_slice(json);
    if !part.is_valid()?.ok_or_else(short)? {
        return Err(RecordingError::Corrupted("its header"));
    }
    header.map_err(|_| RecordingError::Corrupted("its header"))
}

/// Writes a section with its tag and checksum.
pub(super) fn write_section(out: &mut impl Write, tag: [u8; 4], payload: &[u8]) -> io::Result<()> {
    let length = u32::try_from(payload.len()).map_err(|_| io::ErrorKind::FileTooLarge)?;
    write_sealed(out, &[&tag, &length.to_le_bytes(), payload])
}

pub(super) type Section = ([u8; 4], Vec<u8>);

/// Reads the next section, of at most `most` bytes. Returns `None` if the file ends before the end
/// of the section.
pub(super) fn read_section(
    from: &mut impl Read,
    most: u64,
) -> Result<Option<Section>, RecordingError> {
    let mut part = ChecksummedSection {
        from,
        bytes: Vec::new(),
    };
    let Ok(tag) = <[u8; 4]>::try_from(part.take(4)?) else {
        return Ok(None);
    };
    let Some(length) = part.number()? else {
        return Ok(None);
    };
    if u64::from(length) > most {
        return Err(RecordingError::Corrupted("a part of it is too long"));
    }
    if part.take(length.into())?.len() < length as usize {
        return Ok(None);
    }
    match part.is_valid()? {
        Some(true) => {}
        Some(false) => return Err(RecordingError::Corrupted("the checksum of a part differs")),
        None => return Ok(None),
    }
    let payload = 8..8 + length as usize;
    part.bytes.truncate(payload.end);
    part.bytes.drain(..payload.start);
    Ok(Some((tag, part.bytes)))
}

/// Reads until the buffer is full or the file ends. Returns the number of bytes.
fn fill(from: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut have = 0;
    while have < buffer.len() {
        match from.read(&mut buffer[have..]) {
            Ok(0) => break,
            Ok(n) => have += n,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(have)
}

/// Compression level. Level 6 takes twice the time and saves only 2.5 %.
const LEVEL: u32 = 3;

/// Compresses bytes. The zlib format has a checksum.
pub(super) fn deflate(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// Decompresses a part of a recording to at most `limit` bytes.
///
/// # Errors
///
/// [`RecordingError::Corrupted`] if the bytes are corrupted or exceed the limit. An I/O error if
/// memory is insufficient.
pub(super) fn inflate(
    bytes: &[u8],
    limit: u64,
    part: &'static str,
) -> Result<Vec<u8>, RecordingError> {
    let mut inflated = Vec::new();
    let decoder = ZlibDecoder::new(bytes);
    match decoder.take(limit + 1).read_to_end(&mut inflated) {
        Ok(_) if inflated.len() as u64 <= limit => Ok(inflated),
        Err(error) if error.kind() == io::ErrorKind::OutOfMemory => Err(error.into()),
        _ => Err(RecordingError::Corrupted(part)),
    }
}
