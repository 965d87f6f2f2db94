//! Atomic file replacement: a file is written completely or not at all, and foreign files are never
//! overwritten.
//!
//! A file is written next to its target, synced, and then renamed. The next writer in the folder
//! removes leftovers of a killed process.
use std::collections::BTreeSet;
use std::fs::{self, File, Permissions};
use std::io::{self, BufRead as _, BufReader, BufWriter, Read, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use tempfile::NamedTempFile;

use super::budget::PROGRAM;
use super::disk::{self, Call, look};
use super::regular::{is_ordinary, no_link, open, open_own, read_file};

/// Prefix of files in progress. A killed process may leave such a file.
const PARTIAL: &str = ".stochc-partial-";

/// Prefix of the copy of a text whose file is being overwritten. If the process is killed, the copy
/// remains.
const SAVED: &str = ".stochc-saved-";

/// Rule for replacing an existing file.
///
/// Folders, links, pipes, sockets and devices are never replaced.
#[derive(Clone, Copy, Debug)]
pub enum Replaces {
    /// Replaces no file: the name must be free.
    Nothing,
    /// Replaces files that this function recognizes as files of stochc.
    Ours(fn(&mut File) -> io::Result<bool>),
    /// Replaces any regular file. Only for files in folders of stochc.
    Ordinary,
    /// Replaces a file that has the same content, in a folder shared by several machines without
    /// locks. Names of drafts begin with the stem and `.draft-`. Drafts of killed processes are not
    /// removed.
    Same,
}

/// File in progress, without its final name. It is deleted on drop.
#[derive(Debug)]
pub struct Draft {
    file: BufWriter<Unnamed>,
    target: PathBuf,
    replaces: Replaces,
}

/// File under a temporary name, deleted on drop.
#[derive(Debug)]
struct Unnamed(NamedTempFile);

impl Write for Unnamed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        disk::write(self.0.path(), bytes, self.0.as_file())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Draft {
    /// Begins the file for `target`.
    ///
    /// # Errors
    ///
    /// Errors of the file system, and an existing target that must not be replaced.
    pub fn new(target: &Path, replaces: Replaces) -> io::Result<Draft> {
        let old = replaced(target, replaces)?;
        let file = match replaces {
            Replaces::Same => begin_shared(target)?,
            _ => begin(target, 0o666)?,
        };
        if let Some(permissions) = old {
            file.as_file().set_permissions(permissions)?;
        }
        Ok(Draft {
            file: BufWriter::with_capacity(1 << 16, Unnamed(file)),
            target: target.to_owned(),
            replaces,
        })
    }

    /// Returns the content written so far. The caller must flush the draft first.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn written(&self) -> io::Result<disk::File> {
        if !self.file.buffer().is_empty() {
            return Err(io::Error::other("the file is not flushed"));
        }
        open_own(self.file.get_ref().0.path(), File::options().read(true))
    }

    /// Truncates the file to start again.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn rewind(&mut self) -> io::Result<()> {
        self.file.flush()?;
        let Unnamed(file) = self.file.get_mut();
        disk::ask(file.path(), Call::SetLength(0), || {
            file.as_file().set_len(0)
        })?;
        file.rewind()
    }

    /// Gives the file its final name. After this returns, the file survives a power failure.
    ///
    /// # Errors
    ///
    /// Errors of the file system. It is also an error if a file that must not be replaced has
    /// appeared at the target.
    pub fn keep(self) -> io::Result<()> {
        let written = self.file.into_inner().map_err(|error| error.into_error());
        let Unnamed(file) = written?;
        disk::ask(file.path(), Call::Sync, || file.as_file().sync_all())?;
        let replaced = replaced(&self.target, self.replaces)?;
        disk::may(file.path(), Call::Rename(&self.target))?;
        match (replaced, self.replaces) {
            (None, Replaces::Nothing | Replaces::Ours(_) | Replaces::Ordinary) => {
                file.persist_noclobber(&self.target)
            }
            (Some(_), _) | (None, Replaces::Same) => file.persist(&self.target),
        }
        .map_err(|error| error.error)?;
        sync_folder(folder_of(&self.target))
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Replaces the file at `path` atomically: readers see the old or the new content.
///
/// After this returns, the file survives a power failure.
///
/// # Errors
///
/// The errors of [`Draft`]. The old file is then unchanged.
pub fn replace(path: &Path, content: &[u8], replaces: Replaces) -> io::Result<()> {
    let mut draft = Draft::new(path, replaces)?;
    draft.write_all(content)?;
    draft.keep()
}

/// Replaces the `old` text of a user's file by the `new` one. Returns `false` and changes nothing
/// if the file has changed since it was read.
///
/// The file keeps its owner, mode and hard links. A link remains a link.
///
/// # Errors
///
/// Errors of the file system, such as a read-only file. The old text is then unchanged.
pub fn replace_text(path: &Path, old: &[u8], new: &[u8]) -> io::Result<bool> {
    let path = fs::canonicalize(path)?;
    let target = open_own(&path, File::options().write(true))?;
    let metadata = target.metadata()?;
    // Root can write read-only files, so test the permission explicitly.
    if metadata.permissions().readonly() {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    let mut file = begin(&path, 0o600)?;
    file.write_all(new)?;
    let takes_over = is_alone(&metadata) && take_over(file.as_file(), &metadata);
    file.as_file().sync_all()?;
    if read_file(&path, PROGRAM)? != old {
        return Ok(false);
    }
    if takes_over {
        file.persist(&path).map_err(|error| error.error)?;
        sync_folder(folder_of(&path))?;
    } else {
        write_over(target, &path, old, new)?;
    }
    Ok(true)
}

/// Overwrites a file in place, so that it keeps its owner and its hard links. Keeps a copy of the
/// old text next to the file in the meantime.
fn write_over(mut target: disk::File, path: &Path, old: &[u8], new: &[u8]) -> io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let suffix = format!("-{name}");
    let mut builder = tempfile::Builder::new();
    builder.prefix(SAVED).suffix(&suffix);
    let mut saved = builder.tempfile_in(folder_of(path))?;
    saved.write_all(old)?;
    saved.as_file().sync_all()?;
    sync_folder(folder_of(path))?;
    let mut put = |text: &[u8]| {
        target.rewind()?;
        target.write_all(text)?;
        target.set_len(text.len() as u64)?;
        target.sync_all()
    };
    let Err(error) = put(new) else { return Ok(()) };
    // If the old text cannot be restored, keep the copy.
    if put(old).is_err() {
        saved.keep().map_err(|error| error.error)?;
    }
    Err(error)
}

/// Returns whether a file has only one name, that is, no further hard links.
#[cfg_attr(
    not(unix),
    expect(unused_variables, reason = "other systems have no links and modes")
)]
fn is_alone(metadata: &fs::Metadata) -> bool {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::nlink(metadata) == 1;
    #[cfg(not(unix))]
    true
}

/// Gives a file the owner and the mode of another file, if permitted.
fn take_over(file: &File, of: &fs::Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt as _, fchown};
        let Ok(here) = file.metadata() else {
            return false;
        };
        let same = (here.uid(), here.gid()) == (of.uid(), of.gid());
        if !same && fchown(file, Some(of.uid()), Some(of.gid())).is_err() {
            return false;
        }
    }
    file.set_permissions(of.permissions()).is_ok()
}

/// Returns the permissions of the file to be replaced, or `None` if there is none.
fn replaced(target: &Path, replaces: Replaces) -> io::Result<Option<Permissions>> {
    let metadata = match look(target) {
        Ok(metadata) => metadata,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    no_link(&metadata)?;
    is_ordinary(&metadata)?;
    let ours = match replaces {
        Replaces::Nothing => {
            let reason = "the file exists; remove it, or choose another name";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, reason));
        }
        Replaces::Ordinary | Replaces::Same => true,
        Replaces::Ours(ours) => ours(open(target)?.as_plain())?,
    };
    if ours {
        Ok(Some(metadata.permissions()))
    } else {
        Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            "a file of this name exists and was not written by stochc; remove it, or choose another name",
        ))
    }
}

/// Returns whether a file contains a mark after its current position.
///
/// # Errors
///
/// Errors of the file system.
pub fn holds(from: impl Read, mark: &[u8]) -> io::Result<bool> {
    let mut from = BufReader::new(from);
    // The last bytes read, at most the length of the mark.
    let mut seen = Vec::new();
    loop {
        let part = from.fill_buf()?;
        if part.is_empty() {
            return Ok(false);
        }
        seen.extend_from_slice(part);
        let count = part.len();
        from.consume(count);
        if seen.windows(mark.len()).any(|part| part == mark) {
            return Ok(true);
        }
        seen.drain(..seen.len().saturating_sub(mark.len()));
    }
}

/// Returns whether the first 4 KiB of a file contain a mark.
///
/// # Errors
///
/// Errors of the file system.
pub fn begins_with(file: &mut File, mark: &[u8]) -> io::Result<bool> {
    holds(file.take(1 << 12), mark)
}

/// Returns whether the last 1 MiB of a file contain a mark.
///
/// # Errors
///
/// Errors of the file system.
pub fn ends_with(file: &mut File, mark: &[u8]) -> io::Result<bool> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(1 << 20)))?;
    holds(file, mark)
}

/// Creates a draft for [`Replaces::Same`].
fn begin_shared(path: &Path) -> io::Result<NamedTempFile> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    disk::may(path, Call::Create)?;
    new_named(folder_of(path), &format!("{name}.draft-"), 0o666)
}

/// Creates an empty file with a new name that begins with `prefix`.
///
/// # Errors
///
/// Errors of the file system.
pub fn new_own(folder: &Path, prefix: &str) -> io::Result<PathBuf> {
    disk::may(&folder.join(prefix), Call::Create)?;
    let file = new_named(folder, prefix, 0o666)?;
    Ok(file.into_temp_path().keep()?)
}

#[cfg_attr(
    not(unix),
    expect(unused_variables, reason = "other systems have no links and modes")
)]
fn new_named(folder: &Path, prefix: &str, mode: u32) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    builder.tempfile_in(folder).map_err(from_system)
}

/// Creates a locked draft in the folder of `path`, so that no process takes it for a leftover.
fn begin(path: &Path, mode: u32) -> io::Result<NamedTempFile> {
    static CLEARED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let folder = folder_of(path);
    let mut cleared = CLEARED.lock().expect("no panic while it is locked");
    if cleared.insert(folder.to_owned()) {
        // Writing may be permitted even if removal is not.
        let _ = clear_partial(folder);
    }
    drop(cleared);
    loop {
        disk::may(&folder.join(PARTIAL), Call::Create)?;
        let file = new_named(folder, PARTIAL, mode)?;
        // Without file locks, no process removes leftovers.
        let _ = file.as_file().lock();
        // Another process may have removed it as a leftover before we locked it.
        if file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes the name of the draft from an error, because the name means nothing to users.
fn from_system(error: io::Error) -> io::Error {
    match error.to_string().split_once(" at path ") {
        Some((cause, _)) => io::Error::new(error.kind(), cause),
        None => error,
    }
}

/// Returns whether a file is a draft or a leftover.
pub fn is_partial(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().starts_with(PARTIAL)
}

/// Removes the leftovers in a folder.
///
/// # Errors
///
/// Errors of the file system.
pub fn clear_partial(folder: &Path) -> io::Result<()> {
    for path in disk::list(folder)? {
        if !is_partial(&path) {
            continue;
        }
        let file = match open_own(&path, File::options().read(true)) {
            Ok(file) => file,
            // It has been renamed or removed, or belongs to another user.
            Err(_) => continue,
        };
        // Its writer holds a lock.
        if let Ok(Some(lock)) = file.try_lock()
            && lock.is_held()
        {
            disk::remove(&path)?;
        }
    }
    Ok(())
}

/// Removes the files of a folder that `is_ours` selects by name, then the folder. Other files
/// remain.
///
/// # Errors
///
/// Errors of the file system.
pub fn remove_own(folder: &Path, is_ours: impl Fn(&str) -> bool) -> io::Result<()> {
    let entries = match disk::list(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        listed => listed?,
    };
    for entry in entries {
        let name = entry.file_name().unwrap_or_default();
        if is_ours(&name.to_string_lossy()) {
            disk::remove(&entry)?;
        }
    }
    match disk::remove_folder(folder) {
        Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Ok(()),
        removed => removed,
    }
}

/// Moves a file into a folder of stochc under an unused name, and returns its new path.
///
/// # Errors
///
/// Errors of the file system. The file then remains in place.
pub fn move_aside(file: &Path, folder: &Path) -> io::Result<PathBuf> {
    make_own_folder(folder)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let names = (1..).map(|copy| match copy {
        1 => folder.join(&*name),
        copy => folder.join(format!("{name}.{copy}")),
    });
    let mut free = names.filter(|path| fs::symlink_metadata(path).is_err());
    let target = free.next().ok_or(io::ErrorKind::AlreadyExists)?;
    disk::ask(file, Call::Rename(&target), || fs::rename(file, &target))?;
    sync_folder(folder)?;
    sync_folder(folder_of(file))?;
    Ok(target)
}

fn folder_of(path: &Path) -> &Path {
    // A bare name has an empty parent.
    path.parent()
        .filter(|folder| *folder != Path::new(""))
        .unwrap_or(Path::new("."))
}

/// Creates a folder of stochc with its parents. An existing folder is accepted, a link is not.
///
/// # Errors
///
/// Errors of the file system.
pub fn make_own_folder(path: &Path) -> io::Result<()> {
    match look(path) {
        Ok(metadata) => no_link(&metadata)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    make_folder(path)
}

/// Creates a folder with its parents. After this returns, they survive a power failure.
///
/// # Errors
///
/// Errors of the file system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let is_new = |folder: &&Path| *folder != Path::new("") && !folder.exists();
    let new: Vec<&Path> = path.ancestors().take_while(is_new).collect();
    // Another process may have created a folder in the meantime, but that is not a link.
    let is_link = |folder: &&&Path| look(folder).is_ok_and(|it| it.is_symlink());
    if let Some(link) = new.iter().find(is_link) {
        let link = link.display();
        return Err(io::Error::new(
            io::ErrorKind::NotFound,
            format!("`{link}` is a broken symbolic link; remove it, or create its target"),
        ));
    }
    disk::ask(path, Call::MakeFolder, || fs::create_dir_all(path))?;
    new.into_iter()
        .try_for_each(|it| sync_folder(folder_of(it)))
}

/// Makes the names in a folder survive a power failure.
///
/// # Errors
///
/// Errors of the file system.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    // Only Unix allows and needs this.
    if cfg!(unix) {
        let sync = || File::open(folder)?.sync_all();
        disk::ask(folder, Call::SyncFolder, sync)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        reason = "the tests change files outside the code under test"
    )]
    use super::*;

    #[test]
    fn a_concurrent_edit_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let [path, twin] = ["a.sa", "twin"].map(|name| folder.path().join(name));
        fs::write(&path, "mine").unwrap();
        for _ in ["alone", "with another name"] {
            assert!(!replace_text(&path, b"read before", b"new").unwrap());
            assert_eq!(fs::read(&path).unwrap(), b"mine");
            fs::hard_link(&path, &twin).ok();
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_concurrently_created_file_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("page");
        let never = Replaces::Ours(|_| Ok(false));
        let mut draft = Draft::new(&path, never).unwrap();
        draft.write_all(b"ours").unwrap();
        fs::write(&path, "mine").unwrap();
        let error = draft.keep().unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"mine");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_dangling_link_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(folder.path().join("gone"), &link).unwrap();
        for path in [link.clone(), link.join("below")] {
            let error = make_folder(&path).unwrap_err().to_string();
            assert!(error.contains("link` is a broken symbolic link"), "{error}");
        }
        fs::create_dir(folder.path().join("gone")).unwrap();
        make_folder(&link.join("below")).unwrap();
        assert!(folder.path().join("gone/below").is_dir());
    }

    #[test]
    fn folders_can_be_created_concurrently() {
        let folder = tempfile::tempdir().unwrap();
        for round in 0..200 {
            let path = folder.path().join(format!("{round}/results/recordings"));
            std::thread::scope(|scope| {
                let makers = [(); 4].map(|()| scope.spawn(|| make_folder(&path)));
                for maker in makers {
                    maker.join().unwrap().unwrap();
                }
            });
            assert!(path.is_dir());
        }
    }

    #[test]
    fn a_marker_is_found_anywhere() {
        let mark = b"a mark of ours";
        for before in [0, 1, 8191, 8192 - 7, 8192, 20_000] {
            let text = [&vec![b'a'; before][..], mark, b"a"].concat();
            assert!(holds(&text[..], mark).unwrap(), "{before}");
            assert!(!holds(&text[..before + 13], mark).unwrap(), "{before}");
        }
    }
}
