//! A sweep for other programs: JSON, and comma-separated values (RFC 4180).
use serde_json::json;
use stochc_files::csv::CsvTable;

use super::Sweep;
use crate::Manifest;

impl Sweep {
    /// The text of `sweep.json`.
    pub fn to_json(&self, manifest: &Manifest) -> String {
        let value = json!({
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
        let axes = self.axes.iter().map(|axis| axis.label());
        let rest = [
            "runs",
            "completed",
            "timed_out",
            "censored",
            "failed",
            "share",
            "share_low",
            "share_high",
            "unit",
            "mean",
            "half_width",
            "horizon",
            "median",
            "captures",
            "released",
            "time_per_capture",
        ];
        let rest = rest.into_iter().map(str::to_owned);
        let mut table = CsvTable::new(["program".to_owned()].into_iter().chain(axes).chain(rest));
        let maybe = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        for point in &self.points {
            let time = point.time.as_ref();
            let values = point.values.iter().map(|value| value.value.to_string());
            let figures = [
                point.runs.to_string(),
                point.completed.to_string(),
                point.timed_out.to_string(),
                point.censored.to_string(),
                point.failed.to_string(),
                maybe(point.share),
                maybe(point.share_interval.map(|interval| interval.0)),
                maybe(point.share_interval.map(|interval| interval.1)),
                self.unit.to_owned(),
                maybe(time.map(|time| time.mean)),
                maybe(time.and_then(|time| time.half_width)),
                maybe(time.and_then(|time| time.horizon)),
                maybe(time.and_then(|time| time.median)),
                point.captures.to_string(),
                maybe(point.released),
                maybe(point.time_per_capture),
            ];
            let name = std::iter::once(point.program.clone());
            table.row(name.chain(values).chain(figures));
        }
        table.finish()
    }
}
