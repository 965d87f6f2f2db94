//! Table of a comparison, in the layout of the paper's Tables I and II.
use stochc_experiments::{Comparison, Pair, ProgramSummary, Time};
use stochc_text::Tick;

use crate::text::sentence;
use stochc_text::{TextColumn, TextTable, paragraph};

/// Label of a row of seconds below a row of ticks. Side by side, both would be too wide.
const SECONDS: &str = "  in seconds";

/// Cell of an undefined value.
const NONE: &str = "-";

/// Returns the table, followed by a sentence for each pair of programs.
///
/// `width` is the width of the terminal \[characters\]. Columns that do not fit follow below.
pub fn comparison_to_text(comparison: &Comparison, width: usize) -> String {
    let mut rows = ComparisonTableBuilder::new(&comparison.programs);
    rows.add("Construction phases", |c| c.phases.to_string());
    rows.add("Total units involved", |c| c.captures.to_string());
    rows.add("Different blocks used", |c| {
        c.blocks_used.map_or(NONE.into(), |n| format!("{n:.1}"))
    });
    if comparison.programs.iter().any(|c| c.unplanned.is_some()) {
        rows.add("Unplanned bonds", |c| {
            c.unplanned.map_or(NONE.into(), |n| format!("{n:.1}"))
        });
    }
    rows.add("Runs", |c| {
        if c.finished == c.runs {
            c.runs.to_string()
        } else {
            format!("{} of {}", c.finished, c.runs)
        }
    });
    rows.add("Mean time to completion", |c| {
        c.time
            .as_ref()
            .map_or(NONE.into(), |time| in_ticks(time, ""))
    });
    rows.add(SECONDS, |c| in_seconds(c, c.time.as_ref()));
    rows.add("Min time to completion", |c| figure(c, |t| t.min));
    rows.add("Max time to completion", |c| figure(c, |t| t.max));
    rows.add("SD", |c| figure(c, |t| t.sd));
    rows.add("Median", |c| figure(c, |t| t.median));
    rows.add("CV", |c| {
        let cv = c.time.as_ref().and_then(|time| time.cv);
        cv.map_or(NONE.into(), |cv| format!("{cv:.2}"))
    });
    if comparison.programs.iter().any(|c| c.timed_out > 0) {
        rows.add("Timed out", |c| c.timed_out.to_string());
    }
    if comparison.programs.iter().any(|c| c.censored > 0) {
        rows.add("At --max-ticks (censored)", |c| c.censored.to_string());
    }
    if comparison.programs.iter().any(|c| c.failed > 0) {
        rows.add("Failed", |c| c.failed.to_string());
    }
    let phases = comparison
        .programs
        .iter()
        .map(|c| c.phases)
        .max()
        .unwrap_or(0);
    for i in 0..phases {
        rows.add(&format!("Mean of phase {}", i + 1), |c| {
            c.phase_times.get(i).map_or(String::new(), |phase| {
                let mean = (phase.time.as_ref()).map_or(NONE.into(), |time| in_ticks(time, ""));
                format!("{}: {mean}", phase.name)
            })
        });
        rows.add(SECONDS, |c| {
            let phase = c.phase_times.get(i);
            in_seconds(c, phase.and_then(|phase| phase.time.as_ref()))
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

/// Returns a sentence for each pair of programs. A `~` is a non-breaking space.
pub(super) fn pair_sentences(comparison: &Comparison) -> impl Iterator<Item = String> {
    // The correction of the p-values counts only tested differences.
    let tested = comparison
        .pairs
        .iter()
        .filter(|pair| pair.difference.is_some())
        .count();
    let told = move |pair: &Pair| {
        let names = [&*pair.first, &*pair.second];
        sentence(names, &pair.verdict, comparison.unit, tested)
    };
    comparison.pairs.iter().map(told)
}

/// Note on runs ended by a timeout.
pub(super) const NEVER_COMPLETES: &str = "Runs that a timeout of their program has ended never complete: they count as incomplete to the end.";

/// Returns the notes on the values.
fn notes(comparison: &Comparison) -> Vec<String> {
    let mut ticks: Vec<f64> = comparison
        .programs
        .iter()
        .map(|column| column.tick)
        .collect();
    ticks.dedup();
    let tick = match ticks[..] {
        [tick] => Tick(tick).unit(),
        _ => "ticks, each of its own scene".to_owned(),
    };
    let mut notes = vec![format!(
        "Times in {tick}, and in brackets or below in seconds; ± is half of a 95 % interval."
    )];
    if comparison.programs.iter().any(|c| c.finished < c.runs) {
        let note = "Not all runs are finished; those under way longest are missing, so that \
                    times are too short.";
        notes.push(note.to_owned());
    }
    let censored = |c: &ProgramSummary| c.timed_out + c.censored > 0;
    if comparison.programs.iter().any(censored) {
        let note = "≥: some runs were stopped before they completed, so that the mean is one \
                    of min(time, horizon), a lower bound; the median is Kaplan and Meier's, \
                    and SD, CV and the longest time are unknown.";
        notes.push(note.to_owned());
    }
    if comparison.programs.iter().any(|c| c.timed_out > 0) {
        notes.push(NEVER_COMPLETES.to_owned());
    }
    notes
}

/// A table under construction.
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

    fn add(&mut self, label: &str, cell: impl Fn(&ProgramSummary) -> String) {
        self.table.labels.push(label.to_owned());
        for (program, column) in self.programs.iter().zip(&mut self.table.columns) {
            column.cells.push(cell(program));
        }
    }
}

/// Returns a mean with its half-width in ticks and seconds, after `≥` if it is a lower bound.
pub(super) fn mean(time: Option<&Time>, tick: Tick) -> String {
    time.map_or(NONE.to_owned(), |time| {
        in_ticks(time, &tick.beside_interval(time.mean, time.half_width))
    })
}

/// Returns a mean with its half-width in ticks, then the text `beside`. A lower bound starts with
/// `≥`.
pub(super) fn in_ticks(time: &Time, beside: &str) -> String {
    let half_width = time.half_width.map(|half| format!(" ± {}", ticks(half)));
    let text = ticks(time.mean) + &half_width.unwrap_or_default() + beside;
    match time.horizon {
        None => text,
        Some(horizon) => format!("≥ {text}, to {}", ticks(horizon)),
    }
}

/// Returns a mean with its half-width in seconds. Empty without a mean.
fn in_seconds(column: &ProgramSummary, time: Option<&Time>) -> String {
    time.map_or(String::new(), |time| {
        let bound = if time.horizon.is_some() { "≥ " } else { "" };
        bound.to_owned() + &Tick(column.tick).interval(time.mean, time.half_width)
    })
}

fn figure(column: &ProgramSummary, of: impl Fn(&Time) -> Option<f64>) -> String {
    let figure = column.time.as_ref().and_then(of);
    figure.map_or(NONE.to_owned(), |figure| {
        ticks(figure) + &Tick(column.tick).beside(figure)
    })
}

/// Returns ticks as whole numbers, small ones with decimals.
pub(super) fn ticks(ticks: f64) -> String {
    if ticks.abs() < 100.0 && ticks.fract() != 0.0 {
        format!("{ticks:.1}")
    } else {
        format!("{ticks:.0}")
    }
}
