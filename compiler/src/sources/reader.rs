//! Where the texts of programs come from.

/// Reads files for the compiler, which does no IO of its own.
pub trait Reader {
    /// Returns the bytes of a file, or why they cannot be had, in the words of the system.
    ///
    /// `path` is the program's own path joined with that of the import, with `/` between folders.
    fn read(&mut self, path: &str) -> Result<Vec<u8>, String>;

    /// What a file is called wherever it is asked for, if it may have several paths: by links, or by folders that are left again.
    fn identity(&mut self, path: &str) -> Option<String> {
        let _ = path;
        None
    }

    /// Returns the folder within which imports stay, if a file that is imported lies outside of it
    /// and is not to be read.
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
