//! Tables for papers. Each value appears only once, in one unit.
use stochc_experiments::sweep::Sweep;
use stochc_experiments::{Comparison, ProgramSummary, Time};
use stochc_text::{interval, number};

use super::comparison::{NEVER_COMPLETES, pair_sentences};
use super::sweep::sweep_rows;
use stochc_text::{Markup, TextColumn, TextTable};

/// Text of a cell whose value is unknown.
const NONE: &str = "–";

/// Returns a comparison as a table. The results of the pairwise tests follow below.
pub fn published_comparison(comparison: &Comparison, markup: Markup) -> String {
    let unit = comparison.time_unit;
    let mut table = TextTable {
        columns: (comparison.programs.iter())
            .map(|it| TextColumn::figures(&it.name, Vec::new()))
            .collect(),
        ..TextTable::default()
    };
    let mut add = |label: String, cell: &dyn Fn(&ProgramSummary) -> String| {
        table.labels.push(label);
        for (program, column) in comparison.programs.iter().zip(&mut table.columns) {
            column.cells.push(cell(program));
        }
    };
    add("completed".to_owned(), &|it| {
        format!("{}/{}", it.completed, it.finished)
    });
    add(format!("mean [{unit}]"), &|it| mean_cell(it.time.as_ref()));
    type Figure = fn(&Time) -> Option<f64>;
    let mut add_figure = |label: &str, of: Figure| {
        add(format!("{label} [{unit}]"), &|it| {
            figure(it.time.as_ref().and_then(of))
        });
    };
    add_figure("median", |it| it.median);
    add_figure("min", |it| it.min);
    add_figure("max", |it| it.max);
    add_figure("SD", |it| it.sd);
    add("CV".to_owned(), &|it| {
        figure(it.time.as_ref().and_then(|it| it.cv))
    });
    let phases = comparison.programs.iter().map(|it| it.phase_times.len());
    for phase in 0..phases.max().unwrap_or(0) {
        add(format!("phase {} [{unit}]", phase + 1), &|it| {
            it.phase_times.get(phase).map_or(String::new(), |it| {
                format!("{}: {}", it.name, mean_cell(it.time.as_ref()))
            })
        });
    }
    let is_bound = |it: &ProgramSummary| it.timed_out + it.censored > 0;
    let is_bound = comparison.programs.iter().any(is_bound);
    let are_timed_out = comparison.programs.iter().any(|it| it.timed_out > 0);
    markup.table(&table) + &notes(markup, is_bound, are_timed_out) + &pairs(comparison, markup)
}

/// Returns a sweep as a table of its points. The results of the pairwise tests follow below.
pub fn published_sweep(sweep: &Sweep, comparison: &Comparison, markup: Markup) -> String {
    let points = || sweep.points.iter();
    let is_bound = points().any(|it| it.timed_out + it.censored > 0);
    let are_timed_out = points().any(|it| it.timed_out > 0);
    let mut table = sweep_rows(sweep, false);
    for column in &mut table.columns {
        if ["mean time", "median", "per capture"].contains(&&*column.header) {
            column.header += &format!(" [{}]", sweep.unit);
        }
    }
    markup.table(&table) + &notes(markup, is_bound, are_timed_out) + &pairs(comparison, markup)
}

fn notes(markup: Markup, is_bound: bool, are_timed_out: bool) -> String {
    let mut notes = markup.paragraph("± is the 95 % confidence interval of the mean.");
    if is_bound {
        notes += &markup.paragraph(
            "≥ marks a lower bound, because some runs did not complete. The mean is the area under the Kaplan-Meier curve up to the last observed time.",
        );
    }
    if are_timed_out {
        notes += &markup.paragraph(NEVER_COMPLETES);
    }
    notes
}

fn pairs(comparison: &Comparison, markup: Markup) -> String {
    let sentences = pair_sentences(comparison);
    sentences.map(|it| markup.paragraph(&it)).collect()
}

fn mean_cell(time: Option<&Time>) -> String {
    time.map_or(NONE.to_owned(), mean)
}

/// Returns a mean with its half-width, rounded to the same decimals. Marks lower bounds.
pub(super) fn mean(time: &Time) -> String {
    let bound = if time.incomplete > 0 { "≥ " } else { "" };
    let mean = match time.half_width {
        Some(half) => interval(time.mean, half),
        None => number(time.mean),
    };
    bound.to_owned() + &mean
}

fn figure(value: Option<f64>) -> String {
    value.map_or(NONE.to_owned(), number)
}
