//! Progress of work, as a fraction and as text.
use std::collections::BTreeMap;
use std::time::Duration;

use stochc_results::{Manifest, Progress, Snapshot, time_left};
use stochc_text::words;

/// Progress of work: the fraction that is done, and a text for the user.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkProgress {
    /// Fraction of the work that is done, from 0 to 1.
    pub share: f64,
    /// Finished work as text, such as `3 of 50 runs, 1 failed`. The text is also printed at the
    /// end. Empty if the work cannot be counted.
    pub done: String,
    /// Additional text that is shown only during the work. A narrow terminal truncates it.
    pub more: String,
}

/// Returns the progress of an ensemble.
pub fn work_progress(manifest: &Manifest, progress: &Progress, elapsed: Duration) -> WorkProgress {
    let snapshot = progress.snapshot();
    let (done, total) = (snapshot.done, snapshot.total);
    WorkProgress {
        share: (done as f64 / total.max(1) as f64).max(progress.share_of_time().min(1.0)),
        done: format!("{done} of {total} runs{}", troubles(&snapshot)),
        more: rest(manifest, &snapshot, elapsed),
    }
}

/// Returns a text about the remaining time of an ensemble and its running simulations.
fn rest(manifest: &Manifest, snapshot: &Snapshot, elapsed: Duration) -> String {
    /// Largest number of running simulations in the text.
    const SHOWN: usize = 3;
    let mut text = String::new();
    if let Some(left) = time_left(snapshot, elapsed) {
        text += &if left < Duration::from_secs(1) {
            "; less than 1 s left".to_owned()
        } else {
            format!("; about {} left", words(left))
        };
    } else if snapshot.done > 0 && snapshot.ticks_here > 0 {
        text += "; the running simulations already take longer than the mean";
    }
    let mut running = BTreeMap::<_, u64>::new();
    for &(program, phase) in &snapshot.running {
        *running.entry((program, phase)).or_default() += 1;
    }
    let mut places: Vec<_> = running
        .iter()
        .map(|(&(program, phase), runs)| {
            let program = &manifest.programs[program];
            let phase = program.phase(phase);
            match manifest.programs.len() {
                1 => format!("{runs} in {phase}"),
                _ => format!("{runs} in {} {phase}", program.name),
            }
        })
        .collect();
    if places.len() > SHOWN {
        places.truncate(SHOWN);
        places.push("...".to_owned());
    }
    if !places.is_empty() {
        text += &format!("; {}", places.join(", "));
    }
    text
}

/// Returns a text about the number of unsuccessful runs.
fn troubles(snapshot: &Snapshot) -> String {
    let mut text = String::new();
    for (runs, what) in [
        (snapshot.totals.stopped, "stopped"),
        (snapshot.totals.failed, "failed"),
    ] {
        if runs > 0 {
            text += &format!(", {runs} {what}");
        }
    }
    text
}
