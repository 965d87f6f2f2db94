//! Runs of an ensemble until the means are precise enough.
use std::path::Path;

use stochc_experiments::{Comparison, ComparisonTally, ProgramSummary};
use stochc_results::{Manifest, Records, Resume, survey};
use stochc_text::percent;
use stochc_text::{listed, visible};

use super::ensemble::{EnsembleOptions, MadeEnsemble, make_more};
use crate::exit::Failure;
use crate::host::Host;

/// Number of runs per program in the first round.
const FIRST: u64 = 30;

/// Number of runs after which a program with fewer than two completed runs is ignored.
const HOPELESS: u64 = 100;

/// Makes runs until the half-width of every mean's 95 % confidence interval, divided by the mean,
/// is at most `within`. Makes at most the number of runs in `manifest`. Returns the manifest with
/// the final number of runs, and all runs.
///
/// The number of runs depends only on the times of earlier runs. The same command therefore makes
/// the same runs.
///
/// # Errors
/// See [`make`](super::ensemble::make).
pub fn make_until(
    manifest: Manifest,
    within: f64,
    how: &EnsembleOptions<'_>,
    host: &dyn Host,
) -> Result<(Manifest, MadeEnsemble), Failure> {
    let most = manifest.runs;
    let more = |manifest: &Manifest, finished: &Records| {
        let comparison = compared(manifest, finished)?;
        let programs = comparison.programs.iter();
        let programs = programs.map(|it| (it.completed, relative(it)));
        Ok(requested(programs, manifest.runs, within))
    };
    let (manifest, made) = make_in_rounds(manifest, how, host, more)?;
    if made.results.complete {
        let comparison = compared(&manifest, &made.results.finished)?;
        warn_of_unknown(&comparison, [manifest.runs, most], within, host);
    }
    Ok((manifest, made))
}

/// Makes runs in rounds. After each round, `more` returns the number of runs of each program to
/// reach, or `None` to stop. Makes at most the number of runs in `manifest`. Returns the manifest
/// with the final number of runs, and all runs.
///
/// # Errors
/// See [`make`](super::ensemble::make).
pub(super) fn make_in_rounds(
    mut manifest: Manifest,
    how: &EnsembleOptions<'_>,
    host: &dyn Host,
    mut more: impl FnMut(&Manifest, &Records) -> Result<Option<u64>, Failure>,
) -> Result<(Manifest, MadeEnsemble), Failure> {
    let most = manifest.runs;
    let there = how.out.and_then(stored_runs);
    manifest.runs = FIRST.max(there.unwrap_or(0)).min(most);
    let mut stage = EnsembleOptions {
        continues: true,
        ..*how
    };
    let mut existing = Records::default();
    loop {
        let made = make_more(&manifest, existing, &stage, host)?;
        if !made.results.complete {
            return Ok((manifest, made));
        }
        let reached = more(&manifest, &made.results.finished)?;
        let Some(reached) = reached.filter(|_| manifest.runs < most) else {
            return Ok((manifest, made));
        };
        manifest.runs = reached.min(most);
        existing = match how.out {
            None => made.results.finished,
            Some(_) => Records::default(),
        };
        // Rounds after the first resume the runs of earlier rounds. Runs of an earlier command need
        // `--resume`.
        if stage.resume == Resume::No && there.is_none() {
            stage.resume = Resume::SameBuild;
        }
        stage.has_warned_of_build = true;
    }
}

/// Returns the number of runs of each program in the manifest of a folder. Returns `None` if the
/// folder does not exist.
fn stored_runs(out: &Path) -> Option<u64> {
    let stored = survey(out).ok().flatten();
    stored.map(|stored| stored.runs)
}

fn compared(manifest: &Manifest, finished: &Records) -> Result<Comparison, Failure> {
    let mut tally = ComparisonTally::new(manifest);
    (finished.each(|done| tally.add(done))).map_err(Failure::usage)?;
    Ok(tally.finish())
}

/// Returns the half-width of the mean's confidence interval, divided by the mean.
fn relative(program: &ProgramSummary) -> f64 {
    match &program.time {
        Some(time) if time.mean <= 0.0 => 0.0,
        Some(time) => time
            .half_width
            .map_or(f64::INFINITY, |half| half / time.mean),
        None => f64::INFINITY,
    }
}

/// Returns the number of runs per program that is needed for the precision `within`. Returns `None`
/// if the current number `runs` suffices. `programs` contains the number of completed runs and the
/// relative half-width of each program.
fn requested(programs: impl Iterator<Item = (u64, f64)>, runs: u64, within: f64) -> Option<u64> {
    let hopeful = programs.filter(|&(completed, _)| completed >= 2 || runs < HOPELESS);
    let worst = hopeful.map(|(_, relative)| relative).fold(0.0, f64::max);
    if worst <= within {
        return None;
    }
    // The width of an interval is proportional to 1 / sqrt(runs). Early intervals are imprecise.
    let needed = runs as f64 * (worst / within).powi(2);
    let [least, most] = [runs + runs / 10 + 1, runs.saturating_mul(4)];
    Some((needed.min(most as f64).ceil() as u64).max(least))
}

/// Warns about means that are less precise than `within` after the last round. `runs` is the number
/// of runs made, and `most` is the limit.
fn warn_of_unknown(comparison: &Comparison, [runs, most]: [u64; 2], within: f64, host: &dyn Host) {
    let unknown = comparison
        .programs
        .iter()
        .filter(|it| relative(it) > within);
    let unknown: Vec<String> = unknown
        .map(|it| match relative(it) {
            half if half.is_finite() => format!("{} (± {})", visible(&it.name), percent(half)),
            _ => format!("{} ({} completed)", visible(&it.name), it.completed),
        })
        .collect();
    if unknown.is_empty() {
        return;
    }
    let runs = if runs == most {
        format!("with {runs} runs, the most there may be (`--runs`)")
    } else {
        format!("after {runs} runs")
    };
    host.warn(&format!(
        "{runs}, not every mean is known to within {}: {}\n",
        percent(within),
        listed(&unknown, unknown.len())
    ));
}

#[cfg(test)]
mod tests {
    use super::requested;

    #[test]
    fn needed_runs_grow_with_the_square_of_the_precision() {
        let of = |programs: &[(u64, f64)], runs| requested(programs.iter().copied(), runs, 0.05);
        assert_eq!(of(&[(30, 0.05), (30, 0.01)], 30), None);
        assert_eq!(of(&[(30, 0.075), (30, 0.01)], 30), Some(68));
        // The number grows at most fourfold, and always by a few runs.
        assert_eq!(of(&[(30, 0.9)], 30), Some(120));
        assert_eq!(of(&[(200, 0.0501)], 200), Some(221));
        // A program that never completes does not cause more runs.
        let never = (0, f64::INFINITY);
        assert_eq!(of(&[never], 30), Some(120));
        assert_eq!(of(&[never, (120, 0.04)], 120), None);
    }
}
