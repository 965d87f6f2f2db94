//! Reads regular files.
use std::fs::{Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

use super::budget::{PROGRAM, ReadBudget};
use super::disk::{self, File};

/// Returns the bytes of a file for the compiler.
///
/// # Errors
///
/// If the file is not a regular file or is larger than the language allows.
pub fn read(path: &str) -> io::Result<Vec<u8>> {
    read_file(Path::new(path), PROGRAM)
}

/// Returns the bytes of a regular file.
///
/// # Errors
///
/// The errors of [`open`]. A file beyond its limit is also an error.
pub fn read_file(path: &Path, budget: ReadBudget) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    budget.admits(file.metadata()?.len())?;
    read_stream(file, budget)
}

/// Returns all bytes of a stream such as the standard input.
///
/// # Errors
///
/// Errors of the stream. A stream beyond its limit is also an error.
pub(crate) fn read_stream(mut stream: impl Read, budget: ReadBudget) -> io::Result<Vec<u8>> {
    /// Number of bytes between two checks. Smaller files are not checked.
    const CHUNK: u64 = 1 << 24;
    let mut bytes = Vec::new();
    loop {
        let before = bytes.len();
        (&mut stream).take(CHUNK).read_to_end(&mut bytes)?;
        if bytes.len() == before {
            return Ok(bytes);
        }
        if (bytes.len() - before) as u64 == CHUNK {
            budget.accepts(&bytes[before..])?;
        }
        budget.admits(bytes.len() as u64)?;
    }
}

/// Opens a regular file for reading, following links.
///
/// # Errors
///
/// Errors of the file system. Folders, pipes, sockets and devices are rejected: opening them may
/// block or have side effects, and reading may never end.
pub fn open(path: &Path) -> io::Result<File> {
    open_with(path, OpenOptions::new().read(true)).map_err(in_words)
}

/// Replaces the system's messages for the two most frequent errors by shorter ones.
fn in_words(error: io::Error) -> io::Error {
    let words = match error.kind() {
        io::ErrorKind::NotFound => "file not found",
        io::ErrorKind::PermissionDenied => "permission denied",
        _ => return error,
    };
    io::Error::new(error.kind(), words)
}

/// Opens a regular file with other options than [`open`]. The file may be missing if `options`
/// create it.
pub(crate) fn open_with(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    open_flagged(path, options, FOLLOW)
}

#[cfg(unix)]
type Flags = rustix::fs::OFlags;
#[cfg(unix)]
const NO_LINK: Flags = Flags::NOFOLLOW;
#[cfg(unix)]
const FOLLOW: Flags = Flags::empty();
#[cfg(not(unix))]
type Flags = ();
#[cfg(not(unix))]
const NO_LINK: Flags = ();
#[cfg(not(unix))]
const FOLLOW: Flags = ();

#[cfg_attr(
    not(unix),
    allow(unused_variables, reason = "only Unix has such flags")
)]
fn open_flagged(path: &Path, options: &mut OpenOptions, flags: Flags) -> io::Result<File> {
    let is_there = match std::fs::metadata(path) {
        Ok(metadata) => is_ordinary(&metadata).map(|()| true)?,
        // Creation may be requested; otherwise opening reports the error.
        Err(error) if error.kind() == io::ErrorKind::NotFound => false,
        Err(error) => return Err(error),
    };
    // Prevents blocking if the file is replaced in the meantime.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(
        options,
        (flags | Flags::NONBLOCK).bits().cast_signed(),
    );
    let file = File::open(path, options, !is_there)?;
    is_ordinary(&file.metadata()?)?;
    Ok(file)
}

/// Opens a file of stochc, without following links.
///
/// # Errors
///
/// The errors of [`open`]. A link is also an error.
pub fn open_own(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    match disk::look(path) {
        Ok(metadata) => no_link(&metadata)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    open_flagged(path, options, NO_LINK)
}

pub(super) fn is_ordinary(metadata: &Metadata) -> io::Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() {
        "it is a folder"
    } else {
        "it is not a regular file"
    };
    Err(io::Error::new(io::ErrorKind::InvalidInput, what))
}

/// Rejects a link.
pub(super) fn no_link(metadata: &Metadata) -> io::Result<()> {
    if metadata.is_symlink() {
        Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is a symbolic link; remove the link, or name its target",
        ))
    } else {
        Ok(())
    }
}
