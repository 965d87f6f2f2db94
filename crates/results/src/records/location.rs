//! Where a run is kept.

/// Where the line of a run is. The order is that of [`Records`]; of two lines for one run, the first counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct LineLocation {
    pub program: u32,
    pub run: u64,
    /// Its number among the files.
    pub file: u32,
    /// Where it begins \[bytes\].
    pub at: u64,
}

impl LineLocation {
    pub fn key(&self) -> (usize, u64) {
        (self.program as usize, self.run)
    }
}
