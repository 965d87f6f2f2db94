//! Files that are whole or absent, whatever happens while they are written.
use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use tempfile::NamedTempFile;

/// How the files begin that are still being written; a crash may leave one behind.
pub const PARTIAL: &str = ".stochc-partial-";

/// Puts `content` in the place of the file at `path`, so that a reader sees the old or the new.
///
/// It survives a loss of power once this has returned.
///
/// # Errors
/// Those of the file system; the old file is untouched then.
pub fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    replace_if(path, content, || Ok(true)).map(|_| ())
}

/// [`replace`], with the permissions of the old file, if `still` holds right before it goes.
///
/// Tells whether it did.
///
/// # Errors
/// Those of the file system and of `still`; the old file is untouched then.
pub fn replace_if(
    path: &Path,
    content: &[u8],
    still: impl FnOnce() -> io::Result<bool>,
) -> io::Result<bool> {
    let mut file = draft(path)?;
    file.write_all(content)?;
    if let Ok(old) = path.metadata() {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.as_file().sync_all()?;
    if !still()? {
        return Ok(false);
    }
    file.persist(path).map_err(|error| error.error)?;
    sync_folder(folder_of(path))?;
    Ok(true)
}

/// A file in the folder of `path`, for content that gets this name when it is whole.
///
/// # Errors
/// Those of the file system.
pub fn draft(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PARTIAL);
    // A temporary file is private by default; a result is as readable as any other file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(path))
}

fn folder_of(path: &Path) -> &Path {
    // A name alone has an empty parent.
    path.parent()
        .filter(|folder| *folder != Path::new(""))
        .unwrap_or(Path::new("."))
}

/// Makes the names in a folder survive a loss of power.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    // Only Unix lets a folder be opened as a file, and needs it.
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
