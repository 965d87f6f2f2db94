//! The completion curves under the results of an ensemble, on a terminal.
use stochc_experiments::completion_time;
use stochc_experiments::statistics::{KaplanMeier, TimeSample};
use stochc_results::{EnsembleProgram, JournalError, Manifest, Records};
use stochc_text::Tick;
use stochc_text::{Strip, strips};

use super::super::terminal::{is_quiet, output_is_watched, output_width, print};
use crate::exit::Failure;

/// Programs that fit on a screen.
const SHOWN: usize = 4;

/// Draws curves of the runs on a terminal.
pub fn draw(manifest: &Manifest, finished: &Records) -> Result<(), Failure> {
    if is_quiet() || !output_is_watched() {
        return Ok(());
    }
    let curves = curves(manifest, finished).map_err(Failure::usage)?;
    let unit = (manifest.programs.first()).map(|program| Tick(program.scene.tick).unit());
    let mut text = strips(&curves, output_width(), &unit.unwrap_or_default());
    if !text.is_empty() {
        text.insert(0, '\n');
    }
    print(&text)
}

/// The shares of runs that are not complete, of the first few programs; the axis is in ticks, so
/// that programs of different clocks are not drawn together.
fn curves(manifest: &Manifest, finished: &Records) -> Result<Vec<Strip>, JournalError> {
    let first = manifest.programs.first().map(|program| program.scene.tick);
    let mut times = vec![TimeSample::default(); manifest.programs.len()];
    finished.each(|done| {
        let program = &manifest.programs[done.program];
        let time = completion_time(&done.record).filter(|_| Some(program.scene.tick) == first);
        time.into_iter().for_each(|it| times[done.program].push(it));
    })?;
    let strip = |(program, times): (&EnsembleProgram, &TimeSample)| {
        let estimate = KaplanMeier::new(&times.to_vec())?;
        let steps = estimate.curve().into_iter();
        Some(Strip {
            name: program.name.clone(),
            steps: steps.map(|point| (point.time, point.incomplete)).collect(),
            last: estimate.last(),
        })
    };
    let programs = manifest.programs.iter().zip(&times);
    Ok(programs.filter_map(strip).take(SHOWN).collect())
}
