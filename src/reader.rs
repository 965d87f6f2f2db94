//! Reader of programs and their imports from the disk, for the compiler.
use std::io;
use std::path::PathBuf;

use stochc_compiler::Reader;
use stochc_files::bound::{ImportFolders, identity};
use stochc_files::{programs, read};

/// Reader of a program and its imports from the disk. Limits the sizes of the files.
pub(crate) struct DiskReader<'a> {
    program: &'a str,
    text: Option<&'a [u8]>,
    bound: ImportFolders,
}

impl<'a> DiskReader<'a> {
    /// Creates a reader for a program. Imports may also come from the folders `further`. `text`
    /// replaces the content of the program's file.
    pub fn new(program: &'a str, text: Option<&'a [u8]>, further: &[PathBuf]) -> DiskReader<'a> {
        let bound = ImportFolders::new(program, further);
        DiskReader {
            program,
            text,
            bound,
        }
    }
}

impl Reader for DiskReader<'_> {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        match self.text {
            Some(text) if path == self.program => Ok(text.to_vec()),
            _ if path == self.program => programs::read(path),
            _ => read(path),
        }
    }

    fn identity(&mut self, path: &str) -> Option<String> {
        identity(path)
    }

    fn outside(&mut self, path: &str) -> Option<String> {
        self.bound.outside(path)
    }
}
