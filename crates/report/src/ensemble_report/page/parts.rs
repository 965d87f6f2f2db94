//! Data of a page.
use stochc_experiments::sweep::Sweep;
use stochc_experiments::trade::Trade;
use stochc_experiments::{PairwiseTest, Time, TimeUnit};

use crate::analysis::maps::Maps;
use crate::analysis::reported_program::{Input, ReportedProgram};
use crate::analysis::waits::ReportedCapture;
use crate::ensemble_report::ReportLocation;

/// Largest number of rows of a table on the page. The data files are complete.
pub(super) const ROWS: usize = 60;

/// Largest number of points of sweeps with their own sections. Larger sweeps have one section.
const POINTS: usize = 12;

/// Inputs of the page.
pub(crate) struct Parts<'a> {
    pub inputs: &'a [Input],
    pub subjects: &'a [ReportedProgram<'a>],
    pub clock: TimeUnit,
    /// Last observed time of all runs of all programs, in the unit of the page.
    pub last: f64,
    pub waits: &'a [Vec<ReportedCapture>],
    /// Maps of the programs with their own sections.
    pub maps: &'a [Option<Maps>],
    pub pairwise_tests: &'a [PairwiseTest],
    pub sweeps: &'a [Sweep],
    /// Trade of each folder that varies settings.
    pub trades: &'a [Trade],
    pub surroundings: &'a ReportLocation<'a>,
}

impl<'a> Parts<'a> {
    /// Returns the programs with their own sections, with their indices. Points of large sweeps are
    /// left out.
    pub(super) fn detailed(&self) -> impl Iterator<Item = (usize, &'a ReportedProgram<'a>)> {
        detailed(self.subjects)
    }

    /// Returns the time to completion of a program for comparison with the others, in the unit of
    /// the page. Returns `None` if there is none.
    pub(super) fn time(&self, subject: &ReportedProgram) -> Option<Time> {
        Time::beside(&subject.times_by(self.clock), self.last)
    }
}

/// Returns the programs with their own sections, with their indices.
pub(crate) fn detailed<'a, 'b>(
    subjects: &'a [ReportedProgram<'b>],
) -> impl Iterator<Item = (usize, &'a ReportedProgram<'b>)> {
    let is_point = |subject: &ReportedProgram| subject.program.is_point();
    let points = subjects.iter().filter(|subject| is_point(subject));
    let are_many = points.count() > POINTS;
    let all = subjects.iter().enumerate();
    all.filter(move |(_, subject)| !(are_many && is_point(subject)))
}
