//! The frame of the file: a mark, a version, a header, and sections of which each can be passed
//! over without being understood.
use std::io::{self, Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use serde::{Deserialize, Serialize};

/// Of the file format; another one is not read.
pub const VERSION: u32 = 1;

/// How the file begins.
pub(super) const MARK: [u8; 8] = *b"STOCHREC";

/// Places of all blocks at some ticks.
pub(super) const POSES: [u8; 4] = *b"POSE";
/// What happened meanwhile.
pub(super) const EVENTS: [u8; 4] = *b"EVNT";
/// The record of the run; nothing follows.
pub(super) const DONE: [u8; 4] = *b"DONE";

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the `stochc` that recorded.
    pub stochc: String,
    /// Identity of the ensemble's manifest.
    pub ensemble: String,
    /// Index of the program in the manifest.
    pub program: usize,
    /// The number of the run, from 0.
    pub run: u64,
    /// Ticks from one recorded place to the next; places are also kept at every tick that changes
    /// the structure.
    pub every: u32,
    /// Free blocks at the beginning.
    pub bodies: u32,
}

/// Why a recording cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// It begins with something else.
    #[error("it is no recording of a run")]
    Foreign,
    /// It is of a version that this program does not know.
    #[error("its format is version {0}, and this `stochc` reads version {VERSION}")]
    Version(u32),
    /// It ends too early.
    #[error("it was cut short{}", .0.map_or(String::new(), |tick| format!(" after tick {tick}")))]
    CutShort(Option<u64>),
    /// A part of it does not make sense.
    #[error("it is damaged: {0}")]
    Damaged(&'static str),
    /// It could not be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Whether a file begins as a recording does, of any version.
///
/// # Errors
/// Those of the file.
pub fn is_file(file: &mut std::fs::File) -> io::Result<bool> {
    let mut mark = [0; 8];
    Ok(fill(file, &mut mark)? == mark.len() && mark == MARK)
}

/// Writes the beginning of a file.
pub(super) fn write_header(out: &mut impl Write, header: &Header) -> io::Result<()> {
    let json = serde_json::to_vec(header)?;
    out.write_all(&MARK)?;
    out.write_all(&VERSION.to_le_bytes())?;
    out.write_all(&(json.len() as u32).to_le_bytes())?;
    out.write_all(&json)
}

/// Reads the beginning of a file.
pub(super) fn read_header(from: &mut impl Read) -> Result<Header, RecordingError> {
    let mut mark = [0; 8];
    let have = fill(from, &mut mark)?;
    if mark[..have] != MARK[..have] || have == 0 {
        return Err(RecordingError::Foreign);
    }
    let version = number(from)?;
    if version != VERSION {
        return Err(RecordingError::Version(version));
    }
    let length = number(from)?;
    let mut json = Vec::new();
    from.take(length.into()).read_to_end(&mut json)?;
    if json.len() < length as usize {
        return Err(RecordingError::CutShort(None));
    }
    serde_json::from_slice(&json).map_err(|_| RecordingError::Damaged("its header"))
}

/// Writes a section.
pub(super) fn write_section(out: &mut impl Write, tag: [u8; 4], payload: &[u8]) -> io::Result<()> {
    let length = u32::try_from(payload.len()).map_err(|_| io::ErrorKind::FileTooLarge)?;
    out.write_all(&tag)?;
    out.write_all(&length.to_le_bytes())?;
    out.write_all(payload)
}

/// Reads the next section; `None`: the file ends here, or in the midst of it.
pub(super) fn read_section(from: &mut impl Read) -> io::Result<Option<([u8; 4], Vec<u8>)>> {
    let mut tag = [0; 4];
    if fill(from, &mut tag)? < tag.len() {
        return Ok(None);
    }
    let Ok(length) = number(from) else {
        return Ok(None);
    };
    let mut payload = Vec::new();
    from.take(length.into()).read_to_end(&mut payload)?;
    Ok((payload.len() == length as usize).then_some((tag, payload)))
}

fn number(from: &mut impl Read) -> Result<u32, RecordingError> {
    let mut bytes = [0; 4];
    if fill(from, &mut bytes)? < bytes.len() {
        return Err(RecordingError::CutShort(None));
    }
    Ok(u32::from_le_bytes(bytes))
}

/// Reads until the buffer is full or the file ends; how much that was.
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

/// How hard to compress: 6 takes twice the time and gains a fortieth.
const LEVEL: u32 = 3;

/// Compresses; the zlib format, because its checksum finds what has been damaged.
pub(super) fn deflate(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// The counterpart of [`deflate`], for at most `limit` bytes; `None`: it is damaged, or longer.
pub(super) fn inflate(bytes: &[u8], limit: u64) -> Option<Vec<u8>> {
    let mut inflated = Vec::new();
    let decoder = ZlibDecoder::new(bytes);
    decoder.take(limit + 1).read_to_end(&mut inflated).ok()?;
    (inflated.len() as u64 <= limit).then_some(inflated)
}
