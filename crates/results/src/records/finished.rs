//! A finished run of an ensemble.
use serde::{Deserialize, Serialize};
use stochc_ir::record::RunRecord;

use crate::records::LineLocation;

/// Finished run of one of the ensemble's programs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Finished {
    /// Index of the program in the manifest.
    pub program: usize,
    /// Record of the run.
    pub record: RunRecord,
    /// CPU time of the run \[s\]. Measured only in sweeps over settings, and only for runs that
    /// were not resumed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu: Option<f64>,
}

/// Equality ignores the CPU time, which differs between machines.
impl PartialEq for Finished {
    fn eq(&self, other: &Finished) -> bool {
        (self.program, &self.record) == (other.program, &other.record)
    }
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
