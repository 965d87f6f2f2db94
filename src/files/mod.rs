//! Reading programs from the disk, and writing whole files.
pub mod atomic;
pub(crate) mod csv;
pub mod programs;

use std::io::{self, Read as _};
use std::path::Path;

/// The bytes of a file, for the compiler.
///
/// # Errors
///
/// In the system's words, or if the file is no ordinary one or larger than the language allows.
pub fn read(path: &str) -> Result<Vec<u8>, String> {
    /// One byte more than a program may have.
    const LIMIT: u64 = 1 << 32;
    let metadata = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if metadata.is_dir() {
        return Err("it is a folder".into());
    }
    let file = std::fs::File::open(path).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    file.take(LIMIT)
        .read_to_end(&mut bytes)
        .map_err(|error| error.to_string())?;
    if bytes.len() as u64 == LIMIT {
        return Err("it has 4 GiB or more".into());
    }
    Ok(bytes)
}

/// Writes a program over the one that is there, as a whole or not at all; it keeps its permissions,
/// and a link stays a link.
///
/// # Errors
///
/// Those of the file system; the old text is untouched then.
pub fn replace(path: &Path, text: &[u8]) -> io::Result<()> {
    let path = std::fs::canonicalize(path)?;
    if path.metadata()?.permissions().readonly() {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    atomic::replace(&path, text)
}
