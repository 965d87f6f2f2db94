//! How far work is, in words and as a share.
use std::collections::BTreeMap;
use std::time::Duration;

use stochc_results::{Manifest, Progress, Snapshot, time_left};
use stochc_text::words;

/// How far some work is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkProgress {
    /// The part that is done, 0 to 1.
    pub share: f64,
    /// What is done, as the last line says it too: `3 of 50 runs, 1 failed`; empty: there is nothing to say of it.
    pub done: String,
    /// What else there is to say meanwhile; a narrow terminal cuts off the end.
    pub more: String,
}

/// How far an ensemble is.
pub fn of_ensemble(manifest: &Manifest, progress: &Progress, elapsed: Duration) -> WorkProgress {
    let snapshot = progress.snapshot();
    let (done, total) = (snapshot.done, snapshot.total);
    WorkProgress {
        share: (done as f64 / total.max(1) as f64).max(progress.share_of_time().min(1.0)),
        done: format!("{done} of {total} runs{}", troubles(&snapshot)),
        more: rest(manifest, &snapshot, elapsed),
    }
}

/// How long an ensemble will take, and what is under way.
fn rest(manifest: &Manifest, snapshot: &Snapshot, elapsed: Duration) -> String {
    /// More than this is no longer read.
    const SHOWN: usize = 3;
    let mut text = String::new();
    if let Some(left) = time_left(snapshot, elapsed) {
        text += &format!("; about {} left", words(left));
    }
    let mut under_way = BTreeMap::<_, u64>::new();
    for &(program, phase) in &snapshot.under_way {
        *under_way.entry((program, phase)).or_default() += 1;
    }
    let mut places: Vec<_> = under_way
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

/// What went wrong in an ensemble.
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
