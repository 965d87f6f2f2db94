//! The page with its sections in reading order.
mod common;
mod completion;
mod maps;
mod origin;
mod program;
mod summary;
mod sweeps;
mod trades;
mod warnings;

use completion::{completion, differences};
use origin::{methods, origin};
use program::program;
use stochc_experiments::sweep::Sweep;
use stochc_experiments::trade::Trade;
use stochc_experiments::{PairwiseTest, Time, TimeUnit};
use stochc_text::escaped;
use summary::in_short;
use sweeps::sweeps;
use trades::trades;

use crate::analysis::maps::Maps;
use crate::analysis::reported_program::{Input, ReportedProgram};
use crate::analysis::waits::ReportedCapture;
use crate::ensemble_report::html::{Html, name};
use crate::ensemble_report::{MARK, ReportLocation};
use crate::svg::{Drawing, STYLE};

/// Largest number of rows of a table on the page. The data files are complete.
const ROWS: usize = 60;

/// Largest number of points of sweeps with their own sections. Larger sweeps have one section.
const POINTS: usize = 12;

/// Inputs of the page.
pub(super) struct Parts<'a> {
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
    fn detailed(&self) -> impl Iterator<Item = (usize, &'a ReportedProgram<'a>)> {
        detailed(self.subjects)
    }

    /// Returns the time to completion of a program for comparison with the others, in the unit of
    /// the page. Returns `None` if there is none.
    fn time(&self, subject: &ReportedProgram) -> Option<Time> {
        Time::beside(&subject.times_by(self.clock), self.last)
    }
}

/// Returns the programs with their own sections, with their indices.
pub(super) fn detailed<'a, 'b>(
    subjects: &'a [ReportedProgram<'b>],
) -> impl Iterator<Item = (usize, &'a ReportedProgram<'b>)> {
    let is_point = |subject: &ReportedProgram| subject.program.is_point();
    let points = subjects.iter().filter(|subject| is_point(subject));
    let are_many = points.count() > POINTS;
    let all = subjects.iter().enumerate();
    all.filter(move |(_, subject)| !(are_many && is_point(subject)))
}

/// Returns the page, and adds its figures to `drawings`.
pub(super) fn page(parts: &Parts, drawings: &mut Vec<Drawing>) -> String {
    let mut out = Html::default();
    head(parts, &mut out);
    in_short(parts, &mut out);
    completion(parts, &mut out, drawings);
    differences(parts, &mut out);
    sweeps(parts, &mut out, drawings);
    trades(parts, &mut out, drawings);
    for (number, _) in parts.detailed() {
        program(parts, number, &mut out, drawings);
    }
    origin(parts, &mut out);
    methods(parts, &mut out, drawings);
    out.raw("</main>\n</body>\n</html>\n");
    out.finish()
}

fn head(parts: &Parts, out: &mut Html) {
    let names: Vec<&str> = (parts.subjects.iter())
        .map(|subject| subject.label.as_str())
        .collect();
    let title = match names.len() {
        0 => "no programs".to_owned(),
        1..=3 => names.join(", "),
        n => format!("{n} programs"),
    };
    let reload = parts.surroundings.reload.map_or(String::new(), |time| {
        let seconds = time.as_secs_f64().ceil();
        format!("<meta http-equiv=\"refresh\" content=\"{seconds}\"/>\n")
    });
    // The policy forbids all external resources and all scripts, also if a name were not escaped.
    out.raw(&format!(
        "{MARK}\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n{reload}\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'\"/>\n\
         <title>Report: {}</title>\n<style>\n{}{}\n</style>\n</head>\n<body>\n<main>\n",
        escaped(&title),
        include_str!("style.css"),
        *STYLE
    ));
    out.heading(1, "top", &format!("Report: {}", name(&title)));
}
