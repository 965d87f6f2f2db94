//! Programs on the disk.
use std::io::{self, Read as _, Write as _};
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
    let permissions = std::fs::metadata(&path)?.permissions();
    if permissions.readonly() {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    let folder = path.parent().unwrap_or(Path::new("/"));
    let mut file = tempfile::Builder::new()
        .prefix(".stochc-partial-")
        .tempfile_in(folder)?;
    file.write_all(text)?;
    file.as_file().set_permissions(permissions)?;
    file.as_file().sync_all()?;
    file.persist(&path).map_err(|error| error.error)?;
    Ok(())
}
