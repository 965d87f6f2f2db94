//! Pairwise tests of the completion times of programs in a report.
use stochc_experiments::statistics::Runs;
use stochc_experiments::{ComparedProgram, PairwiseTest, TimeUnit, pairwise_tests as compare};

use super::reported_program::ReportedProgram;

/// Tests each pair of programs for a difference in time. Two points of a sweep are tested only if
/// they have different programs and equal parameter values.
pub(crate) fn pairwise_tests(subjects: &[ReportedProgram], clock: TimeUnit) -> Vec<PairwiseTest> {
    let side = |subject: &ReportedProgram| {
        let tick = clock.tick(subject.program);
        Runs::new(subject.manifest.seed, subject.times.clone(), tick)
    };
    let sides: Vec<ComparedProgram> = (subjects.iter())
        .map(|subject| ComparedProgram {
            varied: &subject.program.varied,
            chosen: &subject.program.chosen,
            identity: Some(subject.manifest.runs_identity(subject.program)),
            runs: side(subject),
        })
        .collect();
    compare(&sides)
}
