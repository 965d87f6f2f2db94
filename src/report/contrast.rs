//! Whether two programs take the same time, for every pair of a report.
use super::subject::Subject;
use crate::ensemble::{Clock, Contrast, Side, contrasts as compare, runs};

/// Compares every program with every other one; of a sweep, only different programs at the same
/// values.
pub(super) fn contrasts(subjects: &[Subject], clock: Clock) -> Vec<Contrast> {
    let side = |subject: &Subject| {
        let records = subject.runs.iter().map(|run| &run.record);
        runs(records, subject.manifest.seed, clock.tick(subject.program))
    };
    let sides: Vec<Side> = (subjects.iter())
        .map(|subject| Side {
            varied: &subject.program.varied,
            runs: side(subject),
        })
        .collect();
    let identities: Vec<String> = (subjects.iter())
        .map(|subject| subject.manifest.identity())
        .collect();
    compare(&sides, |i, j| {
        subjects[i].number == subjects[j].number
            && subjects[i].folder != subjects[j].folder
            && identities[i] == identities[j]
    })
}
