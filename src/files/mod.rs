//! Reading programs from the disk, and writing whole files.
pub mod atomic;

use std::io::Read as _;

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
