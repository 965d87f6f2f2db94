//! Position of a run's line in a file.

/// Position of the line that stores a run. Sorted like [`Records`]. If two lines store the same
/// run, the first one counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct LineLocation {
    pub program: u32,
    pub run: u64,
    /// Index of the file.
    pub file: u32,
    /// Position of the start of the line \[bytes\].
    pub at: u64,
}

impl LineLocation {
    pub fn key(&self) -> (usize, u64) {
        (self.program as usize, self.run)
    }
}
