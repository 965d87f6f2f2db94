//! A finished run of an ensemble.
use serde::{Deserialize, Serialize};
use stochc_ir::record::RunRecord;

use super::line_location::LineLocation;

/// A run of one of the ensemble's programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// An index into the manifest's programs.
    pub program: usize,
    /// How it went.
    pub record: RunRecord,
}

impl Finished {
    pub(crate) fn at(&self, file: u32, at: u64) -> LineLocation {
        LineLocation {
            program: u32::try_from(self.program).expect("a manifest has few programs"),
            run: self.record.run,
            file,
            at,
        }
    }
}
