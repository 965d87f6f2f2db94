//! Interface to read the sources of programs.
use std::io;

/// Reads files for the compiler, which itself does no I/O.
pub trait Reader {
    /// Returns the bytes of a file.
    ///
    /// `path` is the path of the importing file joined with the path of the import. Its folders are
    /// separated by `/`.
    ///
    /// # Errors
    ///
    /// Returns an error if the file cannot be read. Diagnostics contain the message.
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>>;

    /// Returns a unique name of a file that may have several paths, because of links or `..`.
    /// Returns `None` if the path is unique.
    fn identity(&mut self, path: &str) -> Option<String> {
        let _ = path;
        None
    }

    /// Returns the folder that imports must not leave, if the file at `path` is outside of it.
    /// Returns `None` if the file may be read.
    fn outside(&mut self, path: &str) -> Option<String> {
        let _ = path;
        None
    }
}

impl<F: FnMut(&str) -> io::Result<Vec<u8>>> Reader for F {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        self(path)
    }
}
