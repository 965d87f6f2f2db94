//! The one way to the disk of all that keeps results: what it asks of the system is a [`Call`], each of which a test can have
//! fail, to see what is left then.
use std::fs::{self, Metadata, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, RwLock};

/// What is asked of the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call<'a> {
    /// To open a file that is there.
    Open,
    /// To make a file, or open the one that is there.
    Create,
    /// To read some bytes.
    Read,
    /// To write these bytes where the file stands.
    Write(&'a [u8]),
    /// To cut a file to so many bytes.
    SetLength(u64),
    /// To have what is in a file survive a loss of power.
    Sync,
    /// To have the names in a folder survive that.
    SyncFolder,
    /// To make a folder.
    MakeFolder,
    /// To give a file this name, whatever has had it before.
    Rename(&'a Path),
    /// To remove a file or an empty folder.
    Remove,
    /// To list a folder.
    List,
    /// To say what is there.
    Look,
    /// To lock a file.
    Lock,
}

/// What becomes of a call.
#[derive(Debug)]
pub enum CallDecision {
    /// The system is asked.
    Proceed,
    /// It fails.
    Fail(io::Error),
    /// Of a write: so many bytes are written, and then it fails.
    Torn(usize, io::Error),
    /// It is said to be done, and is not.
    Pretend,
}

/// In the place of the disk.
pub trait Double: Send + Sync {
    /// Decides on a call that is about to be made.
    fn decide(&self, path: &Path, call: Call) -> CallDecision;
}

/// The doubles, each for what lies in a folder.
static DOUBLES: RwLock<Vec<(PathBuf, Arc<dyn Double>)>> = RwLock::new(Vec::new());
/// How many there are: none, but in a test.
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// Puts a double in the place of the disk for all that lies in a folder, until [`restore`].
pub fn replace_by(folder: &Path, double: Arc<dyn Double>) {
    let mut doubles = DOUBLES.write().expect("nobody panics while it is held");
    doubles.push((folder.to_owned(), double));
    COUNT.store(doubles.len(), Ordering::SeqCst);
}

/// Ends [`replace_by`].
pub fn restore(folder: &Path) {
    let mut doubles = DOUBLES.write().expect("nobody panics while it is held");
    doubles.retain(|(of, _)| of != folder);
    COUNT.store(doubles.len(), Ordering::SeqCst);
}

fn decide(path: &Path, call: Call) -> CallDecision {
    if COUNT.load(Ordering::Relaxed) == 0 {
        return CallDecision::Proceed;
    }
    let double = {
        let doubles = DOUBLES.read().expect("nobody panics while it is held");
        let of = doubles.iter().find(|(folder, _)| path.starts_with(folder));
        of.map(|(_, double)| double.clone())
    };
    double.map_or(CallDecision::Proceed, |double| double.decide(path, call))
}

/// Makes a call, unless it fails before.
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

/// Fails where a call fails that gives something; what is only said to be done is done.
pub(crate) fn may(path: &Path, call: Call) -> io::Result<()> {
    ask(path, call, || Ok(()))
}

/// Writes to something that is the file at `path`.
pub(crate) fn write(path: &Path, bytes: &[u8], mut to: impl Write) -> io::Result<usize> {
    match decide(path, Call::Write(bytes)) {
        CallDecision::Proceed => to.write(bytes),
        CallDecision::Fail(error) => Err(error),
        CallDecision::Torn(count, error) => to.write_all(&bytes[..count]).and(Err(error)),
        CallDecision::Pretend => Ok(bytes.len()),
    }
}

/// A file that is open.
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

    /// As [`fs::File::sync_all`].
    ///
    /// # Errors
    /// Those of the file system.
    pub fn sync_all(&self) -> io::Result<()> {
        ask(&self.path, Call::Sync, || self.file.sync_all())
    }

    /// As [`fs::File::sync_data`].
    ///
    /// # Errors
    /// Those of the file system.
    pub fn sync_data(&self) -> io::Result<()> {
        ask(&self.path, Call::Sync, || self.file.sync_data())
    }

    /// As [`fs::File::set_len`].
    ///
    /// # Errors
    /// Those of the file system.
    pub fn set_len(&self, length: u64) -> io::Result<()> {
        let call = Call::SetLength(length);
        ask(&self.path, call, || self.file.set_len(length))
    }

    /// As [`fs::File::try_clone`].
    ///
    /// # Errors
    /// Those of the file system.
    pub fn try_clone(&self) -> io::Result<File> {
        Ok(File {
            file: self.file.try_clone()?,
            path: self.path.clone(),
        })
    }

    /// Locks it. Returns `None` if another handle has the lock.
    ///
    /// # Errors
    /// Those of the file system.
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

    /// What the system has, for those to whom no test speaks.
    pub(crate) fn as_plain(&mut self) -> &mut fs::File {
        &mut self.file
    }
}

/// A file that has no name any more.
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

/// Where the entries of a folder are.
///
/// # Errors
/// Those of the file system.
pub fn list(folder: &Path) -> io::Result<Vec<PathBuf>> {
    may(folder, Call::List)?;
    let entries = fs::read_dir(folder)?;
    entries.map(|entry| Ok(entry?.path())).collect()
}

/// What is at a path, which may be a link.
///
/// # Errors
/// Those of the file system.
pub fn look(path: &Path) -> io::Result<Metadata> {
    may(path, Call::Look)?;
    fs::symlink_metadata(path)
}

/// Removes a file.
///
/// # Errors
/// Those of the file system.
pub fn remove(path: &Path) -> io::Result<()> {
    ask(path, Call::Remove, || fs::remove_file(path))
}

/// Removes a folder that is empty.
///
/// # Errors
/// Those of the file system.
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
    /// Returns whether other processes are kept out. Some file systems have no locks.
    pub fn is_held(&self) -> bool {
        self.is_held
    }
}

impl Drop for FileLock {
    /// Unlocks the file explicitly. Closing it is not enough: a process that is being started by
    /// another thread shares the open file, and with it the lock, until it executes its program.
    fn drop(&mut self) {
        if self.is_held {
            // The lock ends at the latest with the process.
            let _ = self.file.file.unlock();
        }
    }
}

/// The answer of the file system to a request for a lock.
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
    fn a_file_system_without_locks_keeps_nobody_out() {
        let tried = |number| fs::TryLockError::Error(io::Error::from_raw_os_error(number));
        // ENOSYS and EOPNOTSUPP, as Lustre without `flock` and some mounts of NFS answer.
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
