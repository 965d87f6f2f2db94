//! Statistics of many runs.
use serde_json::{Value, json};
use stochc_estimate::LowerBoundReasons;
use stochc_experiments::completion_time;
use stochc_experiments::statistics::{KaplanMeier, Observation, SurvivalPoint};
use stochc_ir::record::RunRecord;
use stochc_report::estimate::CompletionEstimate;
use stochc_results::EnsembleProgram;

use crate::run::executable;

/// Largest number of events that decide the completion time in a reply.
const MAX_SHARES: usize = 5;

/// Returns `{ completed, times, shares, curve }` of the runs of a program.
///
/// `times` are the mean and quantiles of the completion time with half-widths of 95 % confidence
/// intervals. `shares` are the shares of events on the critical paths. Each point of `curve` is
/// `[ticks, share, low, high]`, the share of completed runs with its interval.
pub fn summarize(text: &str, program: usize, records: &[RunRecord]) -> Result<Value, String> {
    let program = EnsembleProgram::new("program", Vec::new(), executable(text, program)?);
    let records: Vec<&RunRecord> = records.iter().collect();
    let seen = records.iter().filter_map(|record| completion_time(record));
    let seen: Vec<Observation> = seen.collect();
    let curve = KaplanMeier::new(&seen).map_or_else(Vec::new, |curve| curve.curve());
    let estimate = CompletionEstimate::from_runs(&program, &records, LowerBoundReasons::default());
    Ok(json!({
        "completed": estimate.completed,
        "times": estimate.total,
        "shares": estimate.shares.iter().take(MAX_SHARES).collect::<Vec<_>>(),
        "curve": curve.iter().map(point).collect::<Vec<_>>(),
    }))
}

fn point(point: &SurvivalPoint) -> [Option<f64>; 4] {
    let (low, high) = point.interval.unzip();
    let completed = |incomplete| 1.0 - incomplete;
    [
        Some(point.time),
        Some(completed(point.incomplete)),
        high.map(completed),
        low.map(completed),
    ]
}
