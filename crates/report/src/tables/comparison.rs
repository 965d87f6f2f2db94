//! Table of a comparison for a terminal.
use stochc_experiments::{Comparison, Pair, ProgramSummary, Time};
use stochc_text::{Tick, number};

use crate::text::sentence;
use stochc_text::{TextColumn, TextTable, paragraph};

/// Label of a row with seconds, below a row with ticks. A common row would be too wide.
const SECONDS: &str = "  in seconds";

/// Text of a cell whose value is unknown.
const NONE: &str = "-";

/// Returns a table of the compared programs, followed by a sentence for each pair.
///
/// `width` is the width of the terminal \[characters\]. Columns that do not fit are printed below
/// the others.
pub fn comparison_to_text(comparison: &Comparison, width: usize) -> String {
    let programs = &comparison.programs;
    let mut rows = ComparisonTableBuilder::new(programs);
    rows.add("Runs completed", |c| {
        format!("{} of {}", c.completed, c.runs)
    });
    rows.add("Mean time", |c| {
        c.time
            .as_ref()
            .map_or(NONE.into(), |time| in_ticks(time, ""))
    });
    rows.add(SECONDS, |c| in_seconds(c, c.time.as_ref()));
    rows.add("Median", |c| figure(c, |t| t.median));
    rows.add("Min – max", |c| range(c.time.as_ref()));
    rows.add("SD (CV)", |c| spread(c.time.as_ref()));
    rows.add_if_any("Timed out", |c| c.timed_out);
    rows.add_if_any("Censored", |c| c.censored);
    rows.add_if_any("Failed", |c| c.failed);
    rows.add_if_any("Not finished", |c| c.runs - c.finished);
    add_phases(&mut rows);
    rows.add_if_any("With dead blocks", |c| c.dead.unwrap_or(0));
    rows.add("Captures", |c| c.captures.to_string());
    rows.add("Different blocks", |c| {
        c.blocks_used.map_or(NONE.into(), |n| format!("{n:.1}"))
    });
    if programs.iter().any(|c| c.unplanned.is_some()) {
        rows.add("Unplanned bonds", |c| {
            c.unplanned.map_or(NONE.into(), |n| format!("{n:.1}"))
        });
    }
    let mut text = rows.table.text(width, false);
    text.push('\n');
    for note in notes(comparison) {
        text += &paragraph(&note, width);
    }
    text += &pairs_to_text(comparison, width);
    text
}

/// Returns a sentence for each compared pair of programs.
pub fn pairs_to_text(comparison: &Comparison, width: usize) -> String {
    let sentences = pair_sentences(comparison);
    sentences.map(|it| paragraph(&it, width)).collect()
}

/// Returns a sentence for each compared pair of programs. A `~` stands for a non-breaking space.
pub(super) fn pair_sentences(comparison: &Comparison) -> impl Iterator<Item = String> {
    // The correction of p-values counts only the tested differences.
    let tested = comparison
        .pairs
        .iter()
        .filter(|pair| pair.difference.is_some())
        .count();
    let sentence_of_pair = move |pair: &Pair| {
        let names = [&*pair.first, &*pair.second];
        sentence(names, &pair.verdict, comparison.unit, tested)
    };
    comparison.pairs.iter().map(sentence_of_pair)
}

pub(super) const NEVER_COMPLETES: &str =
    "Timed out: a phase of the program reached its timeout. These runs never complete.";

pub(super) const UNFINISHED: &str =
    "Some runs are not finished. The slowest runs are missing, so the times are too short.";

pub(super) const LOWER_BOUND: &str = "≥ marks a lower bound, because some runs did not complete. The mean is the area under the \
     Kaplan-Meier curve up to the last observed time. The median is also of this curve.";

const STOPPED: &str = "Censored: the run was stopped at --max-ticks, or it was measured and is in progress or stopped.";

/// Returns the notes that the values of the table require.
fn notes(comparison: &Comparison) -> Vec<String> {
    let mut ticks: Vec<f64> = comparison
        .programs
        .iter()
        .map(|column| column.tick)
        .collect();
    ticks.dedup();
    let tick = match ticks[..] {
        [tick] => Tick(tick).unit(),
        _ => "ticks of each scene".to_owned(),
    };
    let mut notes = vec![format!(
        "Times are in {tick}. ± is the 95 % confidence interval of the mean."
    )];
    if comparison.programs.iter().any(|c| c.finished < c.runs) {
        notes.push(UNFINISHED.to_owned());
    }
    let censored = |c: &ProgramSummary| c.timed_out + c.censored > 0;
    if comparison.programs.iter().any(censored) {
        notes.push(format!(
            "{LOWER_BOUND} The SD, the CV and the longest time are unknown."
        ));
    }
    if comparison.programs.iter().any(|c| c.censored > 0) {
        notes.push(STOPPED.to_owned());
    }
    if comparison.programs.iter().any(|c| c.timed_out > 0) {
        notes.push(NEVER_COMPLETES.to_owned());
    }
    notes
}

/// Adds a row with the mean time of each phase. Adds nothing if every program has only one phase.
fn add_phases(rows: &mut ComparisonTableBuilder) {
    let phases = rows.programs.iter().map(|c| c.phases).max().unwrap_or(0);
    if phases < 2 {
        return;
    }
    for i in 0..phases {
        rows.add(&format!("Mean of phase {}", i + 1), |c| {
            c.phase_times.get(i).map_or(String::new(), |phase| {
                let mean = (phase.time.as_ref()).map_or(NONE.into(), |time| in_ticks(time, ""));
                format!("{}: {mean}", phase.name)
            })
        });
    }
}

struct ComparisonTableBuilder<'a> {
    programs: &'a [ProgramSummary],
    table: TextTable,
}

impl<'a> ComparisonTableBuilder<'a> {
    fn new(programs: &'a [ProgramSummary]) -> ComparisonTableBuilder<'a> {
        let columns = (programs.iter()).map(|c| TextColumn::figures(&c.name, Vec::new()));
        ComparisonTableBuilder {
            programs,
            table: TextTable {
                columns: columns.collect(),
                ..TextTable::default()
            },
        }
    }

    /// Adds a row of counts. Adds nothing if all counts are 0.
    fn add_if_any(&mut self, label: &str, count: impl Fn(&ProgramSummary) -> u64) {
        if self.programs.iter().any(|program| count(program) > 0) {
            self.add(label, |program| count(program).to_string());
        }
    }

    fn add(&mut self, label: &str, cell: impl Fn(&ProgramSummary) -> String) {
        self.table.labels.push(label.to_owned());
        for (program, column) in self.programs.iter().zip(&mut self.table.columns) {
            column.cells.push(cell(program));
        }
    }
}

/// Returns a mean and its half-width in ticks and seconds. A lower bound begins with `≥`.
pub(super) fn mean(time: Option<&Time>, tick: Tick) -> String {
    time.map_or(NONE.to_owned(), |time| {
        in_ticks(time, &tick.beside_interval(time.mean, time.half_width))
    })
}

/// Returns a mean and its half-width in ticks, followed by `suffix`. A lower bound begins with `≥`.
pub(super) fn in_ticks(time: &Time, suffix: &str) -> String {
    let half_width = time.half_width.map(|half| format!(" ± {}", ticks(half)));
    let text = ticks(time.mean) + &half_width.unwrap_or_default() + suffix;
    match time.horizon {
        None => text,
        Some(horizon) => format!("≥ {text}, to {}", ticks(horizon)),
    }
}

/// Returns a mean and its half-width in seconds. Returns an empty text if `time` is `None`.
fn in_seconds(column: &ProgramSummary, time: Option<&Time>) -> String {
    time.map_or(String::new(), |time| {
        let bound = if time.horizon.is_some() { "≥ " } else { "" };
        bound.to_owned() + &Tick(column.tick).interval(time.mean, time.half_width)
    })
}

/// Returns a statistic as text, in ticks.
fn figure(column: &ProgramSummary, of: impl Fn(&Time) -> Option<f64>) -> String {
    let figure = column.time.as_ref().and_then(of);
    figure.map_or(NONE.to_owned(), ticks)
}

/// Returns the shortest and the longest time as text.
fn range(time: Option<&Time>) -> String {
    let ends = |time: &Time| Some((time.min?, time.max));
    match time.and_then(ends) {
        None => NONE.to_owned(),
        Some((min, None)) => format!("{} – ?", ticks(min)),
        Some((min, Some(max))) => format!("{} – {}", ticks(min), ticks(max)),
    }
}

/// Returns the standard deviation and the coefficient of variation as text.
fn spread(time: Option<&Time>) -> String {
    let spread = |time: &Time| Some((time.sd?, time.cv?));
    match time.and_then(spread) {
        None => NONE.to_owned(),
        Some((sd, cv)) => format!("{} ({cv:.2})", ticks(sd)),
    }
}

/// Returns ticks as an integer with commas between thousands. Small numbers have one decimal.
pub(super) fn ticks(ticks: f64) -> String {
    if ticks.abs() < 100.0 && ticks.fract() != 0.0 {
        format!("{ticks:.1}")
    } else {
        number(ticks.round())
    }
}
