//! Reading ordinary files, and writing whole ones.
pub mod address;
pub mod atomic;
pub mod bound;
pub mod budget;
pub mod checksum;
pub mod csv;
pub mod disk;
pub mod process;
pub mod programs;
pub mod shell;

use std::fs::{Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

use budget::{PROGRAM, ReadBudget};
pub use disk::File;

/// The bytes of a file, for the compiler.
///
/// # Errors
///
/// In the system's words, or if the file is no ordinary one or larger than the language allows.
pub fn read(path: &str) -> Result<Vec<u8>, String> {
    read_file(Path::new(path), PROGRAM).map_err(|error| error.to_string())
}

/// The bytes of an ordinary file.
///
/// # Errors
/// Those of [`open`], and of a file beyond its budget.
pub fn read_file(path: &Path, budget: ReadBudget) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    budget.admits(file.metadata()?.len())?;
    read_stream(file, budget)
}

/// All that a stream gives, such as the standard input.
///
/// # Errors
/// Those of the stream, and of one beyond its budget.
pub(crate) fn read_stream(mut stream: impl Read, budget: ReadBudget) -> io::Result<Vec<u8>> {
    /// Bytes between two looks at what has come; smaller files are not worth one.
    const PIECE: u64 = 1 << 24;
    let mut bytes = Vec::new();
    loop {
        let before = bytes.len();
        (&mut stream).take(PIECE).read_to_end(&mut bytes)?;
        if bytes.len() == before {
            return Ok(bytes);
        }
        if (bytes.len() - before) as u64 == PIECE {
            budget.accepts(&bytes[before..])?;
        }
        budget.admits(bytes.len() as u64)?;
    }
}

/// Opens an ordinary file for reading, or the one that a link leads to.
///
/// # Errors
/// Those of the file system, and of a folder, a pipe, a socket and a device: opening them may wait for
/// somebody else or do something, and reading them may never end.
pub fn open(path: &Path) -> io::Result<File> {
    open_with(path, OpenOptions::new().read(true)).map_err(in_words)
}

/// Replaces the system's words for the two most frequent errors.
fn in_words(error: io::Error) -> io::Error {
    let words = match error.kind() {
        io::ErrorKind::NotFound => "file not found",
        io::ErrorKind::PermissionDenied => "permission denied",
        _ => return error,
    };
    io::Error::new(error.kind(), words)
}

/// [`open`], for other purposes than reading; the file need not be there if `options` create it.
pub fn open_with(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
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
        // It may be made now; if not, opening it says so.
        Err(error) if error.kind() == io::ErrorKind::NotFound => false,
        Err(error) => return Err(error),
    };
    // What takes its place meanwhile is not waited for either.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(
        options,
        (flags | Flags::NONBLOCK).bits().cast_signed(),
    );
    let file = File::open(path, options, !is_there)?;
    is_ordinary(&file.metadata()?)?;
    Ok(file)
}

/// [`open_with`], for a file of ours: not the one that a link leads to.
///
/// # Errors
/// Those of [`open`], and of a link.
pub fn open_own(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    match disk::look(path) {
        Ok(metadata) => atomic::no_link(&metadata)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    open_flagged(path, options, NO_LINK)
}

fn is_ordinary(metadata: &Metadata) -> io::Result<()> {
    if metadata.is_file() {
        return Ok(());
    }
    let what = if metadata.is_dir() {
        "it is a folder"
    } else {
        "it is no ordinary file"
    };
    Err(io::Error::new(io::ErrorKind::InvalidInput, what))
}
