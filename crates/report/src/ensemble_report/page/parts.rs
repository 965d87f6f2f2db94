//! Data that the sections of a page use.
use stochc_experiments::sweep::Sweep;
use stochc_experiments::trade::Trade;
use stochc_experiments::{PairwiseTest, Time, TimeUnit};

use crate::analysis::maps::Maps;
use crate::analysis::reported_program::{Input, ReportedProgram};
use crate::analysis::waits::ReportedCapture;
use crate::ensemble_report::ReportLocation;

/// Largest number of rows in a table on the page. The data files contain all rows.
pub(super) const ROWS: usize = 60;

/// Largest number of points in a sweep with one section per point. A larger sweep has one section
/// in total.
const POINTS: usize = 12;

/// Data that the sections of a page use.
pub(crate) struct Parts<'a> {
    pub inputs: &'a [Input],
    pub subjects: &'a [ReportedProgram<'a>],
    pub clock: TimeUnit,
    /// Latest observed time of all runs of all programs, in the unit of the page.
    pub last: f64,
    pub waits: &'a [Vec<ReportedCapture>],
    /// Maps of each program that has its own section.
    pub maps: &'a [Option<Maps>],
    pub pairwise_tests: &'a [PairwiseTest],
    pub sweeps: &'a [Sweep],
    /// Trade (speed against accuracy) of each results folder whose sweep varies settings.
    pub trades: &'a [Trade],
    pub surroundings: &'a ReportLocation<'a>,
}

impl<'a> Parts<'a> {
    /// Returns the programs that have their own section, with their indices. Excludes points of
    /// large sweeps.
    pub(super) fn detailed(&self) -> impl Iterator<Item = (usize, &'a ReportedProgram<'a>)> {
        detailed(self.subjects)
    }

    /// Returns the statistics of a program's completion time, in the unit of the page. The
    /// statistics of different programs can be compared with each other. Returns `None` if no run
    /// has a time.
    pub(super) fn time(&self, subject: &ReportedProgram) -> Option<Time> {
        Time::beside(&subject.times_by(self.clock), self.last)
    }
}

pub(crate) fn detailed<'a, 'b>(
    subjects: &'a [ReportedProgram<'b>],
) -> impl Iterator<Item = (usize, &'a ReportedProgram<'b>)> {
    let is_point = |subject: &ReportedProgram| subject.program.is_point();
    let points = subjects.iter().filter(|subject| is_point(subject));
    let are_many = points.count() > POINTS;
    let all = subjects.iter().enumerate();
    all.filter(move |(_, subject)| !(are_many && is_point(subject)))
}
