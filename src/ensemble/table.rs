//! A comparison as text, in the layout of the paper's Tables I and II.
use super::comparison::{Column, Comparison, Pair, Time};
use super::contrast::{Verdict, sentence};
use super::layout::{Layout, paragraph};
use crate::figures::Tick;

/// In place of a figure that does not exist.
const NONE: &str = "-";

impl Comparison {
    /// The table, and below it a sentence for each pair of programs.
    ///
    /// `width` is that of the terminal, in characters; columns that do not fit go below.
    pub fn to_text(&self, width: usize) -> String {
        let mut rows = Rows::new(&self.programs);
        rows.add("Construction phases", |c| c.phases.to_string());
        rows.add("Total units involved", |c| c.captures.to_string());
        rows.add("Different blocks used", |c| {
            c.blocks_used.map_or(NONE.into(), |n| format!("{n:.1}"))
        });
        if self.programs.iter().any(|c| c.unplanned.is_some()) {
            rows.add("Unplanned bonds", |c| {
                c.unplanned.map_or(NONE.into(), |n| format!("{n:.1}"))
            });
        }
        rows.add("Runs", |c| match c.finished == c.runs {
            true => c.runs.to_string(),
            false => format!("{} of {}", c.finished, c.runs),
        });
        rows.add("Mean time to completion", |c| {
            mean(c.time.as_ref(), Tick(c.tick))
        });
        rows.add("Min time to completion", |c| figure(c, |t| t.min));
        rows.add("Max time to completion", |c| figure(c, |t| t.max));
        rows.add("SD", |c| figure(c, |t| t.sd));
        rows.add("Median", |c| figure(c, |t| t.median));
        rows.add("CV", |c| {
            let cv = c.time.as_ref().and_then(|time| time.cv);
            cv.map_or(NONE.into(), |cv| format!("{cv:.2}"))
        });
        rows.add("Timed out (censored)", |c| c.timed_out.to_string());
        if self.programs.iter().any(|c| c.stopped > 0) {
            rows.add("At --max-ticks (censored)", |c| c.stopped.to_string());
        }
        rows.add("Failed", |c| c.failed.to_string());
        let phases = self.programs.iter().map(|c| c.phases).max().unwrap_or(0);
        for i in 0..phases {
            rows.add(&format!("Mean of phase {}", i + 1), |c| {
                match c.phase_times.get(i) {
                    Some(phase) => {
                        let mean = mean(phase.time.as_ref(), Tick(c.tick));
                        format!("{}: {mean}", phase.name)
                    }
                    None => String::new(),
                }
            });
        }
        let mut text = rows.layout.text(width);
        text.push('\n');
        for note in self.notes() {
            text += &paragraph(&note, width);
        }
        text += &self.pairs_to_text(width);
        text
    }

    /// A sentence for each pair of programs that are compared.
    pub fn pairs_to_text(&self, width: usize) -> String {
        let told = |pair: &Pair| {
            let verdict = pair.difference.clone();
            let verdict = verdict.map_or(Verdict::Unknown, Verdict::Known);
            let names = [&*pair.first, &*pair.second];
            paragraph(
                &sentence(names, &verdict, self.unit, self.pairs.len()),
                width,
            )
        };
        self.pairs.iter().map(told).collect()
    }

    /// What the figures mean.
    fn notes(&self) -> Vec<String> {
        let mut ticks: Vec<f64> = self.programs.iter().map(|column| column.tick).collect();
        ticks.dedup();
        let tick = match ticks[..] {
            [tick] => Tick(tick).unit(),
            _ => "ticks, each of its own scene".to_owned(),
        };
        let mut notes = vec![format!(
            "Times in {tick}, and in brackets in seconds; ± is half of a 95 % interval."
        )];
        if self.programs.iter().any(|c| c.finished < c.runs) {
            let note = "Not all runs are finished; those under way longest are missing, so that \
                        times are too short.";
            notes.push(note.to_owned());
        }
        let censored = |c: &Column| c.timed_out + c.stopped > 0;
        if self.programs.iter().any(censored) {
            let note = "≥: some runs were stopped before they completed, so that the mean is one \
                        of min(time, horizon), a lower bound; the median is Kaplan and Meier's, \
                        and SD, CV and the longest time are unknown.";
            notes.push(note.to_owned());
        }
        notes
    }
}

/// The table while it grows.
struct Rows<'a> {
    programs: &'a [Column],
    layout: Layout,
}

impl<'a> Rows<'a> {
    fn new(programs: &'a [Column]) -> Rows<'a> {
        let columns = programs.iter().map(|c| (c.name.clone(), Vec::new()));
        Rows {
            programs,
            layout: Layout {
                labels: Vec::new(),
                columns: columns.collect(),
            },
        }
    }

    fn add(&mut self, label: &str, cell: impl Fn(&Column) -> String) {
        self.layout.labels.push(label.to_owned());
        for (program, (_, cells)) in self.programs.iter().zip(&mut self.layout.columns) {
            cells.push(cell(program));
        }
    }
}

/// A mean with half of its interval, in ticks and in seconds; `≥` before a lower bound.
pub(crate) fn mean(time: Option<&Time>, tick: Tick) -> String {
    let Some(time) = time else {
        return NONE.to_owned();
    };
    let mut text = ticks(time.mean);
    if let Some(half_width) = time.half_width {
        text += &format!(" ± {}", ticks(half_width));
    }
    text += &tick.beside_interval(time.mean, time.half_width);
    match time.horizon {
        None => text,
        Some(horizon) => format!("≥ {text}, to {}", ticks(horizon)),
    }
}

fn figure(column: &Column, of: impl Fn(&Time) -> Option<f64>) -> String {
    let figure = column.time.as_ref().and_then(of);
    figure.map_or(NONE.to_owned(), |figure| {
        ticks(figure) + &Tick(column.tick).beside(figure)
    })
}

/// Whole ticks, except where they are few.
pub(crate) fn ticks(ticks: f64) -> String {
    if ticks.abs() < 100.0 && ticks.fract() != 0.0 {
        format!("{ticks:.1}")
    } else {
        format!("{ticks:.0}")
    }
}
