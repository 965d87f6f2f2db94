//! The shares of runs of an ensemble that are not complete, over time.
use stochc_ensemble::statistics::Observation;
use stochc_ensemble::{JournalError, Manifest, ProgramTimes, Records, TimeUnit, completion_time};

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
    if !manifest.axes().is_empty() {
        return Ok(None);
    }
    let mut times = vec![Vec::new(); manifest.programs.len()];
    finished.each(|done| times[done.program].extend(completion_time(&done.record)))?;
    let times = times.into_iter().map(|times| (times, 0));
    Ok(drawn(medium, manifest, times))
}

/// The same while runs go on, which count as censored, of at most so many programs: without them the curve would be that of the runs
/// that happened to be short.
pub(crate) fn completion_so_far(
    manifest: &Manifest,
    times: &[ProgramTimes],
    most: usize,
) -> Option<Drawing> {
    drawn(
        Medium::Screen,
        manifest,
        times.iter().take(most).map(so_far),
    )
}

/// Times of a program \[ticks\], and how many of them, the last ones, are of runs that still go on.
fn so_far(program: &ProgramTimes) -> (Vec<Observation>, usize) {
    let under_way = program.under_way.iter();
    let under_way = under_way.map(|&ticks| Observation::censored(ticks as f64));
    let all = program.finished.iter().chain(under_way).collect();
    (all, program.under_way.len())
}

/// Curves of programs, of each the times \[ticks\] and how many of them are of runs that still go on.
fn drawn(
    medium: Medium,
    manifest: &Manifest,
    times: impl Iterator<Item = (Vec<Observation>, usize)>,
) -> Option<Drawing> {
    let clock = TimeUnit::of(manifest.programs.iter());
    let curves: Vec<SurvivalCurve> = (manifest.programs.iter().zip(times))
        .map(|(program, (mut times, under_way))| {
            let tick = clock.tick(program);
            times.iter_mut().for_each(|it| it.time *= tick);
            SurvivalCurve {
                name: program.name.clone(),
                times,
                under_way,
            }
        })
        .collect();
    let axis = PlotAxis::new("time", clock.unit());
    let title = "Runs that are not complete yet, over time";
    survival(
        medium,
        "survival",
        title,
        &curves,
        (&axis, &incomplete()),
        Colours::Compared,
    )
}

#[cfg(test)]
mod tests {
    use stochc_ensemble::statistics::KaplanMeier;

    use super::*;

    #[test]
    fn runs_under_way_are_neither_complete_nor_left_out() {
        let finished = [100.0, 200.0].map(Observation::completed);
        let mut program = ProgramTimes::default();
        finished.iter().for_each(|&it| program.finished.push(it));
        program.under_way = vec![150, 5000];
        let (times, under_way) = so_far(&program);
        assert_eq!(under_way, 2);
        // At 100, one of four; at 200, one of the two that are still seen.
        let estimate = KaplanMeier::of(&times).unwrap();
        assert_eq!(estimate.incomplete(199.0), 0.75);
        assert_eq!(estimate.incomplete(1e9), 0.375);
    }
}
