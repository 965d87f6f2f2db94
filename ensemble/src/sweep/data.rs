//! A sweep for other programs: JSON, and comma-separated values (RFC 4180).
use serde_json::json;

use super::Sweep;
use crate::{Manifest, sweep_table};

/// Version of the format of `sweep.json`.
const FORMAT: u32 = 1;

impl Sweep {
    /// The text of `sweep.json`.
    pub fn to_json(&self, manifest: &Manifest) -> String {
        let value = json!({
            "format": FORMAT,
            "stochc": manifest.stochc,
            "ensemble": manifest.identity(),
            "axes": self.axes,
            "unit": self.unit,
            "points": self.points,
        });
        format!("{value:#}\n")
    }

    /// The text of `sweep.csv`: a row for each point, a column for each axis.
    pub fn to_csv(&self) -> String {
        sweep_table(self).csv()
    }
}
