//! Disk access for all code that keeps results. Each request to the system is a [`Call`], and tests
//! can make any call fail.
use std::fs::{self, Metadata, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, RwLock};

/// Call of the file system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call<'a> {
    /// Opens an existing file.
    Open,
    /// Creates a file, or opens an existing one.
    Create,
    /// Reads bytes.
    Read,
    /// Writes these bytes at the current position.
    Write(&'a [u8]),
    /// Sets the length of a file \[bytes\].
    SetLength(u64),
    /// Makes the content of a file survive a power failure.
    Sync,
    /// Makes the names in a folder survive a power failure.
    SyncFolder,
    /// Creates a folder.
    MakeFolder,
    /// Renames a file to this path, replacing any file there.
    Rename(&'a Path),
    /// Removes a file or an empty folder.
    Remove,
    /// Lists a folder.
    List,
    /// Reads the metadata of a path.
    Look,
    /// Locks a file.
    Lock,
}

/// Outcome of a call.
#[derive(Debug)]
pub enum CallDecision {
    /// The call is passed on to the operating system.
    Proceed,
    /// The call fails.
    Fail(io::Error),
    /// This number of bytes is written, then the call fails.
    Torn(usize, io::Error),
    /// The call succeeds without effect.
    Pretend,
}

/// Replacement of file system calls in tests.
pub trait Double: Send + Sync {
    /// Decides the outcome of a call before it is made.
    fn decide(&self, path: &Path, call: Call) -> CallDecision;
}

/// Test doubles, each with the folder whose contents it replaces.
static DOUBLES: RwLock<Vec<(PathBuf, Arc<dyn Double>)>> = RwLock::new(Vec::new());
/// Number of test doubles: 0 except in tests.
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// Installs a test double for the contents of a folder, until [`restore`].
pub fn replace_by(folder: &Path, double: Arc<dyn Double>) {
    let mut doubles = DOUBLES.write().expect("no panic while it is locked");
    doubles.push((folder.to_owned(), double));
    COUNT.store(doubles.len(), Ordering::SeqCst);
}

/// Removes the test double of a folder.
pub fn restore(folder: &Path) {
    let mut doubles = DOUBLES.write().expect("no panic while it is locked");
    doubles.retain(|(of, _)| of != folder);
    COUNT.store(doubles.len(), Ordering::SeqCst);
}

fn decide(path: &Path, call: Call) -> CallDecision {
    if COUNT.load(Ordering::Relaxed) == 0 {
        return CallDecision::Proceed;
    }
    let double = {
        let doubles = DOUBLES.read().expect("no panic while it is locked");
        let of = doubles.iter().find(|(folder, _)| path.starts_with(folder));
        of.map(|(_, double)| double.clone())
    };
    double.map_or(CallDecision::Proceed, |double| double.decide(path, call))
}

/// Makes a call unless a test double decides otherwise.
pub(crate) fn ask<T: Default>(
    path: &Path,
    call: Call,
    make: impl FnOnce() -> io::Result<T>,
) -> io::Result<T> {
    match decide(path, call) {
        CallDecision::Proceed => make(),
        CallDecision::Fail(error) | CallDecision::Torn(_, error) => Err(error),
        CallDecision::Pretend => Ok(T::default()),
    }
}

/// Returns an error if a test double makes the call fail. Used for calls with a result that a test
/// double cannot provide.
pub(crate) fn may(path: &Path, call: Call) -> io::Result<()> {
    ask(path, call, || Ok(()))
}

pub(crate) fn write(path: &Path, bytes: &[u8], mut to: impl Write) -> io::Result<usize> {
    match decide(path, Call::Write(bytes)) {
        CallDecision::Proceed => to.write(bytes),
        CallDecision::Fail(error) => Err(error),
        CallDecision::Torn(count, error) => to.write_all(&bytes[..count]).and(Err(error)),
        CallDecision::Pretend => Ok(bytes.len()),
    }
}

/// Open file.
#[derive(Debug)]
pub struct File {
    file: fs::File,
    path: PathBuf,
}

impl File {
    pub(crate) fn open(path: &Path, options: &OpenOptions, is_new: bool) -> io::Result<File> {
        may(path, if is_new { Call::Create } else { Call::Open })?;
        Ok(File {
            file: options.open(path)?,
            path: path.to_owned(),
        })
    }

    /// Calls [`fs::File::sync_all`].
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn sync_all(&self) -> io::Result<()> {
        ask(&self.path, Call::Sync, || self.file.sync_all())
    }

    /// Calls [`fs::File::sync_data`].
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn sync_data(&self) -> io::Result<()> {
        ask(&self.path, Call::Sync, || self.file.sync_data())
    }

    /// Calls [`fs::File::set_len`].
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn set_len(&self, length: u64) -> io::Result<()> {
        let call = Call::SetLength(length);
        ask(&self.path, call, || self.file.set_len(length))
    }

    /// Calls [`fs::File::try_clone`].
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn try_clone(&self) -> io::Result<File> {
        Ok(File {
            file: self.file.try_clone()?,
            path: self.path.clone(),
        })
    }

    /// Locks the file. Returns `None` if another handle has the lock.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn try_lock(self) -> io::Result<Option<FileLock>> {
        may(&self.path, Call::Lock)?;
        let is_held = match lock(self.file.try_lock())? {
            Lock::Ours => true,
            Lock::Others => return Ok(None),
            Lock::Unsupported => false,
        };
        Ok(Some(FileLock {
            file: self,
            is_held,
        }))
    }

    /// Returns the system's file, without test doubles.
    pub(crate) fn as_plain(&mut self) -> &mut fs::File {
        &mut self.file
    }
}

/// Wraps a file that no longer has a name.
impl From<fs::File> for File {
    fn from(file: fs::File) -> File {
        let path = PathBuf::new();
        File { file, path }
    }
}

impl Deref for File {
    type Target = fs::File;

    fn deref(&self) -> &fs::File {
        &self.file
    }
}

impl Read for &File {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        may(&self.path, Call::Read)?;
        (&self.file).read(bytes)
    }
}

impl Write for &File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write(&self.path, bytes, &self.file)
    }

    fn flush(&mut self) -> io::Result<()> {
        (&self.file).flush()
    }
}

impl Seek for &File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        (&self.file).seek(to)
    }
}

impl Read for File {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        (&*self).read(bytes)
    }
}

impl Write for File {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (&*self).write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        (&*self).flush()
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        (&*self).seek(to)
    }
}

/// Returns the paths of a folder's entries.
///
/// # Errors
///
/// Errors of the file system.
pub fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    may(folder, Call::List)?;
    let entries = fs::read_dir(folder)?;
    entries.map(|entry| Ok(entry?.path())).collect()
}

/// Returns the metadata of a path without following links.
///
/// # Errors
///
/// Errors of the file system.
pub fn look(path: &Path) -> io::Result<Metadata> {
    may(path, Call::Look)?;
    fs::symlink_metadata(path)
}

/// Removes a file.
///
/// # Errors
///
/// Errors of the file system.
pub fn remove(path: &Path) -> io::Result<()> {
    ask(path, Call::Remove, || fs::remove_file(path))
}

/// Removes an empty folder.
///
/// # Errors
///
/// Errors of the file system.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    ask(path, Call::Remove, || fs::remove_dir(path))
}

/// A lock on an open file, released when it is dropped.
#[derive(Debug)]
pub struct FileLock {
    file: File,
    is_held: bool,
}

impl FileLock {
    /// Returns whether the lock keeps other processes out. Some file systems have no locks.
    pub fn is_held(&self) -> bool {
        self.is_held
    }
}

impl Drop for FileLock {
    /// Unlocks the file explicitly, because closing is not enough. If another thread starts a child
    /// process, the child shares the open file and its lock until `exec`.
    fn drop(&mut self) {
        if self.is_held {
            // The lock ends with the process at the latest.
            let _ = self.file.file.unlock();
        }
    }
}

/// Response of the file system to a lock request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lock {
    Ours,
    Others,
    Unsupported,
}

fn lock(tried: Result<(), fs::TryLockError>) -> io::Result<Lock> {
    match tried {
        Ok(()) => Ok(Lock::Ours),
        Err(fs::TryLockError::WouldBlock) => Ok(Lock::Others),
        Err(fs::TryLockError::Error(error)) => match error.kind() {
            io::ErrorKind::Unsupported => Ok(Lock::Unsupported),
            _ => Err(error),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_system_without_locks_is_allowed() {
        let tried = |number| fs::TryLockError::Error(io::Error::from_raw_os_error(number));
        // ENOSYS and EOPNOTSUPP, returned by Lustre without `flock` and some NFS mounts.
        #[cfg(target_os = "linux")]
        for number in [38, 95] {
            assert_eq!(lock(Err(tried(number))).unwrap(), Lock::Unsupported);
        }
        assert!(lock(Err(tried(5))).is_err());
        let taken = lock(Err(fs::TryLockError::WouldBlock));
        assert_eq!(taken.unwrap(), Lock::Others);
    }

    #[test]
    fn a_dropped_lock_is_released_while_processes_are_started() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let is_done = std::sync::atomic::AtomicBool::new(false);
        let order = std::sync::atomic::Ordering::Relaxed;
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_done.load(order) {
                    std::process::Command::new("true").status().unwrap();
                }
            });
            let refused = (0..2000).filter(|_| {
                let options = OpenOptions::new()
                    .create(true)
                    .truncate(false)
                    .write(true)
                    .clone();
                let file = File::open(&path, &options, false).unwrap();
                file.try_lock().unwrap().is_none()
            });
            let refused = refused.count();
            is_done.store(true, order);
            assert_eq!(refused, 0);
        });
    }
}
