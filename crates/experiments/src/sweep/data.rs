//! Export of a sweep as JSON and as comma-separated values (RFC 4180).
use super::Sweep;
use crate::stamped_json::stamped_json;
use crate::summary_tables::sweep_table;
use stochc_results::Manifest;

impl Sweep {
    /// Returns the text of `sweep.json`.
    pub fn to_json(&self, manifest: &Manifest) -> String {
        stamped_json(self, manifest)
    }

    /// Returns the text of `sweep.csv`, with a row for each point and a column for each axis.
    pub fn to_csv(&self) -> String {
        sweep_table(self).csv()
    }
}
