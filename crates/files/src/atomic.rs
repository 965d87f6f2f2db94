//! The one way of writing files: whole or not at all, and never in the place of somebody else's.
//!
//! A file is written beside its target, synced, and then given its name. What a kill leaves is removed by the
//! next who writes into the folder.
use std::collections::BTreeSet;
use std::fs::{self, File, Permissions};
use std::io::{self, BufRead as _, BufReader, BufWriter, Read, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use tempfile::NamedTempFile;

use super::budget::PROGRAM;
use super::disk::{self, Call, look};
use super::{is_ordinary, open, open_own, read_file};

/// How the files begin that are still being written; a kill may leave one behind.
const PARTIAL: &str = ".stochc-partial-";

/// How a copy of a text begins while its file is written over; a kill may leave one behind, and nobody removes it.
const SAVED: &str = ".stochc-saved-";

/// Which file may give its name to a new one.
///
/// A folder, a link, a pipe, a socket or a device never does.
#[derive(Clone, Copy, Debug)]
pub enum Replaces {
    /// None: there has to be nothing of that name.
    Nothing,
    /// One that this says is of our making.
    Ours(fn(&mut File) -> io::Result<bool>),
    /// Any: the name is ours, in a folder that is.
    Ordinary,
    /// One that is the same, whoever is the last to write it: in a folder into which several machines write, where locks
    /// mean nothing. What a kill leaves begins with the stem of the name and `.draft-`, and is not removed.
    Same,
}

/// A file that is being written, and has not got its name yet; it is gone if it is dropped.
#[derive(Debug)]
pub struct Draft {
    file: BufWriter<Unnamed>,
    target: PathBuf,
    replaces: Replaces,
}

/// A file without its name; that of its own is removed with it.
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
    /// Begins the file that will be at `target`.
    ///
    /// # Errors
    /// Those of the file system, and of a target that would replace what is not ours.
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

    /// What has been written, all of which has to be flushed.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn written(&self) -> io::Result<super::File> {
        if !self.file.buffer().is_empty() {
            return Err(io::Error::other("some of it is not flushed"));
        }
        open_own(self.file.get_ref().0.path(), File::options().read(true))
    }

    /// Begins the file anew.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn rewind(&mut self) -> io::Result<()> {
        self.file.flush()?;
        let Unnamed(file) = self.file.get_mut();
        disk::ask(file.path(), Call::SetLength(0), || {
            file.as_file().set_len(0)
        })?;
        file.rewind()
    }

    /// Gives it its name; it survives a loss of power once this has returned.
    ///
    /// # Errors
    /// Those of the file system, and of what has appeared at the target meanwhile, which is untouched then.
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

/// Puts `content` at `path`, so that a reader sees the old or the new.
///
/// It survives a loss of power once this has returned.
///
/// # Errors
/// Those of [`Draft`]; the old file is untouched then.
pub fn replace(path: &Path, content: &[u8], replaces: Replaces) -> io::Result<()> {
    let mut draft = Draft::new(path, replaces)?;
    draft.write_all(content)?;
    draft.keep()
}

/// Puts the `new` text of a user's file in the place of the `old` one, unless it has changed meanwhile: then it
/// is left as it is, and `false` is returned.
///
/// The file keeps its owner, its mode and its other names, and a link stays a link.
///
/// # Errors
/// Those of the file system; a file that may not be written is one. The old text is untouched then.
pub fn replace_text(path: &Path, old: &[u8], new: &[u8]) -> io::Result<bool> {
    let path = fs::canonicalize(path)?;
    let target = open_own(&path, File::options().write(true))?;
    let metadata = target.metadata()?;
    // Those who may do everything have to be asked.
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

/// Writes over a file that has other names or another owner, with a copy of it beside it meanwhile.
fn write_over(mut target: super::File, path: &Path, old: &[u8], new: &[u8]) -> io::Result<()> {
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
    // Whoever cannot have the old text back has the copy.
    if put(old).is_err() {
        saved.keep().map_err(|error| error.error)?;
    }
    Err(error)
}

/// Whether a file has no other names.
fn is_alone(metadata: &fs::Metadata) -> bool {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::nlink(metadata) == 1;
    #[cfg(not(unix))]
    true
}

/// Gives a file the owner and the mode of another one, if we may.
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

/// The permissions of the file that a new one would replace; `None`: there is none.
fn replaced(target: &Path, replaces: Replaces) -> io::Result<Option<Permissions>> {
    let metadata = match look(target) {
        Ok(metadata) => metadata,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    no_link(&metadata)?;
    is_ordinary(&metadata)?;
    let ours = match replaces {
        Replaces::Nothing => false,
        Replaces::Ordinary | Replaces::Same => true,
        Replaces::Ours(ours) => ours(open(target)?.as_plain())?,
    };
    if ours {
        Ok(Some(metadata.permissions()))
    } else {
        Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            "a file of this name is there, which may be somebody else's; remove it, or choose another name",
        ))
    }
}

/// Refuses a link.
pub(super) fn no_link(metadata: &fs::Metadata) -> io::Result<()> {
    if metadata.is_symlink() {
        Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is no ordinary file but a link; remove the link, or name the file that it leads to",
        ))
    } else {
        Ok(())
    }
}

/// Whether a file holds a mark, from where it stands to its end.
///
/// # Errors
/// Those of the file system.
pub fn holds(from: impl Read, mark: &[u8]) -> io::Result<bool> {
    let mut from = BufReader::new(from);
    // The last bytes that were read, as many as the mark has.
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

/// Whether a file holds a mark within its first bytes, some thousands.
///
/// # Errors
/// Those of the file system.
pub fn begins_with(file: &mut File, mark: &[u8]) -> io::Result<bool> {
    holds(file.take(1 << 12), mark)
}

/// Whether a file holds a mark within its last bytes, a million.
///
/// # Errors
/// Those of the file system.
pub fn ends_with(file: &mut File, mark: &[u8]) -> io::Result<bool> {
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(1 << 20)))?;
    holds(file, mark)
}

/// A file of [`Replaces::Same`].
fn begin_shared(path: &Path) -> io::Result<NamedTempFile> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    disk::may(path, Call::Create)?;
    new_named(folder_of(path), &format!("{name}.draft-"), 0o666)
}

/// Makes an empty file of a new name in a folder, which begins with `prefix`.
///
/// # Errors
/// Those of the file system.
pub fn new_own(folder: &Path, prefix: &str) -> io::Result<PathBuf> {
    disk::may(&folder.join(prefix), Call::Create)?;
    let file = new_named(folder, prefix, 0o666)?;
    Ok(file.into_temp_path().keep()?)
}

fn new_named(folder: &Path, prefix: &str, mode: u32) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    builder.tempfile_in(folder).map_err(of_system)
}

/// A file in the folder of `path` that nobody takes for the leaving of a kill.
fn begin(path: &Path, mode: u32) -> io::Result<NamedTempFile> {
    static CLEARED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let folder = folder_of(path);
    let mut cleared = CLEARED.lock().expect("nobody panics while it is held");
    if cleared.insert(folder.to_owned()) {
        // Whoever may not remove anything may still write.
        let _ = clear_partial(folder);
    }
    drop(cleared);
    loop {
        disk::may(&folder.join(PARTIAL), Call::Create)?;
        let file = new_named(folder, PARTIAL, mode)?;
        // Where nothing can be locked, nobody clears anything either.
        let _ = file.as_file().lock();
        // Somebody may have taken it for a leaving before it was locked.
        if file.path().exists() {
            return Ok(file);
        }
    }
}

/// The error without the name of the draft, of which nobody knows.
fn of_system(error: io::Error) -> io::Error {
    match error.to_string().split_once(" at path ") {
        Some((cause, _)) => io::Error::new(error.kind(), cause),
        None => error,
    }
}

/// Whether a file is one that is still being written, or that a kill has left.
pub fn is_partial(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().starts_with(PARTIAL)
}

/// Removes what kills have left in a folder of files that were being written.
///
/// # Errors
/// Those of the file system.
pub fn clear_partial(folder: &Path) -> io::Result<()> {
    for path in disk::list(folder)? {
        if !is_partial(&path) {
            continue;
        }
        let file = match open_own(&path, File::options().read(true)) {
            Ok(file) => file,
            // Its owner has been quicker, or it is none of ours.
            Err(_) => continue,
        };
        // Whoever still writes it holds a lock.
        if let Ok(Some(lock)) = file.try_lock()
            && lock.is_held()
        {
            disk::remove(&path)?;
        }
    }
    Ok(())
}

/// Removes the files of a folder whose names are ours, and the folder; what somebody else has put there stays.
///
/// # Errors
/// Those of the file system.
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

/// Moves a file into a folder of ours beside it, where it gets a name that is not taken; tells where it is.
///
/// # Errors
/// Those of the file system; the file is where it was then.
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
    // A name alone has an empty parent.
    path.parent()
        .filter(|folder| *folder != Path::new(""))
        .unwrap_or(Path::new("."))
}

/// Makes a folder of ours, and those above it; what is there may be a folder but no link to one.
///
/// # Errors
/// Those of the file system.
pub fn make_own_folder(path: &Path) -> io::Result<()> {
    match look(path) {
        Ok(metadata) => no_link(&metadata)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    make_folder(path)
}

/// Makes a folder, and those above it; they survive a loss of power once this has returned.
///
/// # Errors
/// Those of the file system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let is_new = |folder: &&Path| *folder != Path::new("") && !folder.exists();
    let new: Vec<&Path> = path.ancestors().take_while(is_new).collect();
    // A folder that somebody else has made meanwhile is no link.
    let is_link = |folder: &&&Path| look(folder).is_ok_and(|it| it.is_symlink());
    if let Some(link) = new.iter().find(is_link) {
        let link = link.display();
        return Err(io::Error::new(
            io::ErrorKind::NotFound,
            format!(
                "`{link}` is a link that leads nowhere; remove it, or make the folder that it leads to"
            ),
        ));
    }
    disk::ask(path, Call::MakeFolder, || fs::create_dir_all(path))?;
    new.into_iter()
        .try_for_each(|it| sync_folder(folder_of(it)))
}

/// Makes the names in a folder survive a loss of power.
///
/// # Errors
/// Those of the file system.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    // Only Unix lets a folder be opened as a file, and needs it.
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
        reason = "the tests change files behind the back of the code"
    )]
    use super::*;

    #[test]
    fn an_edit_made_meanwhile_stays() {
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
    fn what_has_appeared_meanwhile_stays() {
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
    fn a_link_that_leads_nowhere_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink(folder.path().join("gone"), &link).unwrap();
        for path in [link.clone(), link.join("below")] {
            let error = make_folder(&path).unwrap_err().to_string();
            assert!(
                error.contains("link` is a link that leads nowhere"),
                "{error}"
            );
        }
        fs::create_dir(folder.path().join("gone")).unwrap();
        make_folder(&link.join("below")).unwrap();
        assert!(folder.path().join("gone/below").is_dir());
    }

    #[test]
    fn folders_are_made_by_several_at_once() {
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
    fn a_mark_is_found_wherever_it_is() {
        let mark = b"a mark of ours";
        for before in [0, 1, 8191, 8192 - 7, 8192, 20_000] {
            let text = [&vec![b'a'; before][..], mark, b"a"].concat();
            assert!(holds(&text[..], mark).unwrap(), "{before}");
            assert!(!holds(&text[..before + 13], mark).unwrap(), "{before}");
        }
    }
}
