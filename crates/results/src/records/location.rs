//! Position of a run in a file.

/// Position of the line of a run. Sorted like [`Records`]; of two lines for one run, the first
/// counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct LineLocation {
    pub program: u32,
    pub run: u64,
    /// Index of the file.
    pub file: u32,
    /// Start of the line \[bytes\].
    pub at: u64,
}

impl LineLocation {
    pub fn key(&self) -> (usize, u64) {
        (self.program as usize, self.run)
    }
}
