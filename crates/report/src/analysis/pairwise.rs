//! Tests for different times of every pair of programs of a report.
use stochc_experiments::statistics::Runs;
use stochc_experiments::{ComparedProgram, PairwiseTest, TimeUnit, pairwise_tests as compare};

use super::reported_program::ReportedProgram;

/// Compares all pairs of programs. Points of a sweep are compared only if they have equal values
/// and different programs.
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
