//! Figure of completion: the share of incomplete runs over time.
use stochc_experiments::{TimeUnit, completion_time};
use stochc_results::{JournalError, Manifest, Records};

use super::{SurvivalCurve, incomplete, survival};
use crate::svg::{Colours, Drawing, Medium, PlotAxis};

/// Draws the completion curves of all programs of an ensemble, in a common unit. Returns `None` for
/// a sweep, which has the figures of [`super::sweep`]. Also returns `None` if no run has a time.
///
/// # Errors
///
/// If the runs cannot be read again.
pub fn completion(
    medium: Medium,
    manifest: &Manifest,
    finished: &Records,
) -> Result<Option<Drawing>, JournalError> {
    if manifest.programs.iter().any(|it| it.is_point()) {
        return Ok(None);
    }
    let mut times = vec![Vec::new(); manifest.programs.len()];
    finished.each(|done| times[done.program].extend(completion_time(&done.record)))?;
    let clock = TimeUnit::common(manifest.programs.iter());
    let curves: Vec<SurvivalCurve> = (manifest.programs.iter().zip(times))
        .map(|(program, mut times)| {
            let tick = clock.tick(program);
            times.iter_mut().for_each(|it| it.time *= tick);
            let name = program.name.clone();
            SurvivalCurve { name, times }
        })
        .collect();
    let axis = PlotAxis::new("time", clock.unit());
    let title = "Share of incomplete runs over time";
    Ok(survival(
        medium,
        "survival",
        title,
        &curves,
        (&axis, &incomplete()),
        Colours::Compared,
    ))
}
