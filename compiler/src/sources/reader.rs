//! Interface to read the sources of programs.

/// Reads files for the compiler, which itself does no I/O.
pub trait Reader {
    /// Returns the bytes of a file, or why they cannot be had, in the words of the system.
    ///
    /// `path` is the program's own path joined with that of the import, with `/` between folders.
    fn read(&mut self, path: &str) -> Result<Vec<u8>, String>;

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

impl<F: FnMut(&str) -> Result<Vec<u8>, String>> Reader for F {
    fn read(&mut self, path: &str) -> Result<Vec<u8>, String> {
        self(path)
    }
}
