//! The shares of runs of an ensemble that are not complete, over time.
use stochc_ensemble::statistics::Observation;
use stochc_ensemble::{JournalError, Manifest, Records, TimeUnit, completion_time};

use super::{SurvivalCurve, incomplete, survival};
use crate::svg::{Axis, Colours, Drawing, Medium};

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
    if !manifest.axes().is_empty() {
        return Ok(None);
    }
    let clock = TimeUnit::of(manifest.programs.iter());
    let mut curves: Vec<SurvivalCurve> = (manifest.programs.iter())
        .map(|program| SurvivalCurve {
            name: program.name.clone(),
            times: Vec::new(),
        })
        .collect();
    finished.each(|done| {
        let tick = clock.tick(&manifest.programs[done.program]);
        let time = completion_time(&done.record).map(|it| Observation {
            time: it.time * tick,
            ..it
        });
        curves[done.program].times.extend(time);
    })?;
    let axis = Axis::new("time", clock.unit());
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
