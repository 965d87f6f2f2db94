//! Export of a sweep: JSON, and comma-separated values (RFC 4180).
use serde_json::json;

use super::Sweep;
use crate::summary_tables::sweep_table;
use stochc_results::Manifest;

/// Version of the format of `sweep.json`.
const FORMAT: u32 = 1;

impl Sweep {
    /// Returns the text of `sweep.json`.
    pub fn to_json(&self, manifest: &Manifest) -> String {
        let mut value = json!(self);
        value["format"] = FORMAT.into();
        value["stochc"] = json!(manifest.stochc);
        value["ensemble"] = manifest.identity().into();
        format!("{value:#}\n")
    }

    /// Returns the text of `sweep.csv`: a row for each point, a column for each axis.
    pub fn to_csv(&self) -> String {
        sweep_table(self).csv()
    }
}
