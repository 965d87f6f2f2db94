//! The shares of runs of an ensemble that are not complete, over time.
use stochc_experiments::{TimeUnit, completion_time};
use stochc_results::{JournalError, Manifest, Records};

use super::{SurvivalCurve, incomplete, survival};
use crate::svg::{Colours, Drawing, Medium, PlotAxis};

/// Curves of its programs, in the unit that they share; `None`: nothing has completed or been stopped, or the ensemble is
/// a sweep, of which [`super::sweep`] has pictures.
///
/// # Errors
/// Where the runs cannot be read again.
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
    let title = "Runs that are not complete yet, over time";
    Ok(survival(
        medium,
        "survival",
        title,
        &curves,
        (&axis, &incomplete()),
        Colours::Compared,
    ))
}
