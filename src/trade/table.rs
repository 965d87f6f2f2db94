//! A trade as text.
use super::advice::{convergence, relative, share};
use super::ranking::Verdict;
use super::report::{Cell, Program, Rung, Trade};
use crate::ensemble::{paragraph, ticks};
use crate::figures::{Tick, seconds};

/// In place of a figure that does not exist.
const NONE: &str = "-";

const HEADER: [&str; 11] = [
    "#", "setting", "CPU/run", "ratio", "n", "mean", "bias", "D", "p", "cens.", "failed",
];

/// The column of the settings, the only one that is not of figures.
const SETTING: usize = 1;

/// One line of a table.
struct Line {
    cells: Vec<String>,
    /// Behind the columns.
    remark: String,
    /// In red where there are colours.
    wrong: bool,
}

impl Trade {
    /// A table for each program, the order of the programs, and what to make of it.
    ///
    /// `width` is that of the terminal, for the sentences; `colour` marks what is wrong in red.
    pub fn to_text(&self, width: usize, colour: bool) -> String {
        let mut text = String::new();
        for (i, program) in self.programs.iter().enumerate() {
            text += &format!("{}\n", program.name);
            let line = |(n, rung): (usize, &Rung)| self.line(n, rung, i);
            let lines = self.rungs.iter().enumerate().map(line).collect::<Vec<_>>();
            text += &columns(&HEADER, &lines, colour);
            text.push('\n');
        }
        if self.programs.len() > 1 && self.reference.is_some() {
            text += &self.ranking(colour);
            text.push('\n');
        }
        for note in self.notes() {
            text += &paragraph(&note, width);
        }
        text.push('\n');
        text += &paragraph(&self.advice, width);
        text
    }

    fn line(&self, number: usize, rung: &Rung, program: usize) -> Line {
        let cell = &rung.programs[program];
        let itself = self.reference.as_ref().is_some_and(|r| r.rung == number);
        let mut cells = vec![(number + 1).to_string(), rung.name.clone()];
        let mut remark = String::new();
        if cell.runs == 0 {
            remark = rung
                .left_out
                .clone()
                .unwrap_or("there was no time for it".into());
        } else {
            cells.extend(self.figures(cell, itself, program));
        }
        if itself {
            remark = "reference".into();
        } else if rung.reversed {
            remark = "REVERSED".into();
        } else if rung.front {
            remark = "front".into();
        }
        Line {
            cells,
            remark,
            wrong: rung.reversed,
        }
    }

    fn figures(&self, cell: &Cell, itself: bool, program: usize) -> [String; 9] {
        let or_none = |text: Option<String>| text.unwrap_or(NONE.to_owned());
        let reference = self.reference_rung();
        let whole = reference.and_then(|rung| rung.programs[program].cost);
        let ratio = cell
            .cost
            .zip(whole)
            .map(|(cost, whole)| share(cost / whole));
        let bound = if cell.horizon.is_some() { "≥ " } else { "" };
        let tick = Tick(self.programs[program].scene.tick);
        let mean = cell.mean.map(|mean| {
            let half = cell.half_width.map(|half| format!(" ± {}", ticks(half)));
            let beside = tick.beside_interval(mean, cell.half_width);
            format!("{bound}{}{}{beside}", ticks(mean), half.unwrap_or_default())
        });
        let blank = |text: Option<String>| match itself {
            true => String::new(),
            false => or_none(text),
        };
        [
            or_none(cell.cost.map(seconds)),
            or_none(ratio),
            cell.runs.to_string(),
            or_none(mean),
            blank(
                cell.bias
                    .as_ref()
                    .map(|bias| format!("{bound}{}", relative(bias))),
            ),
            blank(cell.distance.map(|distance| format!("{:.2}", distance.d))),
            blank(cell.distance.map(|distance| probability(distance.p))),
            cell.censored.to_string(),
            cell.failed.to_string(),
        ]
    }

    /// What each setting says about the order of the programs.
    fn ranking(&self, colour: bool) -> String {
        let pairs = self.reference_rung().map_or(&[][..], |rung| &rung.ranking);
        let ordered = pairs
            .iter()
            .filter(|pair| pair.verdict != Verdict::Unordered);
        let ordered: Vec<String> = ordered
            .map(|pair| self.pair(pair.first, pair.second))
            .collect();
        if ordered.is_empty() {
            return "By the reference's runs, it is undecided of every two programs which takes \
                    longer, so that there is no order to keep.\n"
                .to_owned();
        }
        let mut text = format!(
            "Order of the means, by the reference: {}\n",
            ordered.join(", ")
        );
        let count = |rung: &Rung, verdict| {
            let pairs = rung.ranking.iter().filter(|pair| pair.verdict == verdict);
            pairs.count().to_string()
        };
        let rungs = self
            .rungs
            .iter()
            .enumerate()
            .filter(|(_, rung)| !rung.ranking.is_empty());
        let lines: Vec<Line> = rungs
            .map(|(number, rung)| Line {
                cells: vec![
                    (number + 1).to_string(),
                    rung.name.clone(),
                    count(rung, Verdict::Kept),
                    count(rung, Verdict::Unclear),
                    count(rung, Verdict::Reversed),
                ],
                remark: match rung.reversed {
                    false => String::new(),
                    true => {
                        let pairs = rung.reversals();
                        let pairs = pairs.map(|pair| self.pair(pair.first, pair.second));
                        format!("REVERSED: {}", pairs.collect::<Vec<_>>().join(", "))
                    }
                },
                wrong: rung.reversed,
            })
            .collect();
        text += &columns(
            &["#", "setting", "kept", "unclear", "reversed"],
            &lines,
            colour,
        );
        text
    }

    fn pair(&self, first: usize, second: usize) -> String {
        format!(
            "{} < {}",
            self.programs[first].name, self.programs[second].name
        )
    }

    /// What the figures mean.
    fn notes(&self) -> Vec<String> {
        let mut notes = vec![
            "Settings are model and substeps, and what differs from the defaults. CPU/run is the \
             median processor time of a run, ratio the same over the reference's; means are in \
             ticks, in brackets in seconds; bias is the mean over the reference's, less one; D is the largest difference \
             of the two shares of completed runs, p its probability by chance alone; ±~is half \
             of a 95~% interval. front: no cheaper setting is known to be as close."
                .to_owned(),
        ];
        if let (Some(reference), Some(rung)) = (&self.reference, self.reference_rung()) {
            let last = reference.doublings.last();
            let changes = last.iter().flat_map(|last| &last.changes);
            let changes = changes.map(|change| match change {
                Some(change) => relative(change),
                None => "unknown".to_owned(),
            });
            let changes: Vec<String> = changes.collect();
            notes.push(format!(
                "Reference: `{}`, the finest that was measured. {}",
                rung.options,
                convergence(reference, &changes.join(", "))
            ));
        }
        let cells = || self.rungs.iter().flat_map(|rung| &rung.programs);
        if cells().any(|cell| cell.censored > 0) {
            let limit = |program: &Program| format!("{} {}", program.name, program.max_ticks);
            let limits: Vec<String> = self.programs.iter().map(limit).collect();
            notes.push(format!(
                "cens.: runs stopped by a timeout of the program or the limit of ticks ({}). Means \
                 of such samples (≥) count up to the last time seen, their biases up to the last \
                 that both samples tell of, and D times before the first censored one.",
                limits.join(", ")
            ));
        }
        if cells().any(|cell| cell.failed > 0) {
            notes
                .push("failed: the physics broke down; no figure but the cost counts them.".into());
        }
        if !self.complete {
            notes.push("It was interrupted: this is what was measured until then.".into());
        }
        notes
    }
}

/// Aligned columns: texts to the left, figures to the right.
fn columns<const N: usize>(header: &[&str; N], lines: &[Line], colour: bool) -> String {
    let chars = |text: &str| text.chars().count();
    let widths: Vec<usize> = (0..N)
        .map(|i| {
            let cells = lines.iter().filter_map(|line| line.cells.get(i));
            cells
                .map(|cell| chars(cell))
                .chain([chars(header[i])])
                .max()
                .unwrap_or(0)
        })
        .collect();
    let row = |cells: &[&str], remark: &str| {
        let mut text = String::new();
        for (i, cell) in cells.iter().enumerate() {
            let gap = if i == 0 { "" } else { "  " };
            text += &match i {
                SETTING => format!("{gap}{cell:<width$}", width = widths[i]),
                _ => format!("{gap}{cell:>width$}", width = widths[i]),
            };
        }
        if !remark.is_empty() {
            text += &format!("  {remark}");
        }
        text.trim_end().to_owned()
    };
    let rules: Vec<String> = widths.iter().map(|&width| "─".repeat(width)).collect();
    let rules: Vec<&str> = rules.iter().map(String::as_str).collect();
    let mut text = format!("{}\n{}\n", row(header, ""), row(&rules, ""));
    for line in lines {
        let cells: Vec<&str> = line.cells.iter().map(String::as_str).collect();
        let row = row(&cells, &line.remark);
        text += &match line.wrong && colour {
            true => console::style(row).red().force_styling(true).to_string(),
            false => row,
        };
        text.push('\n');
    }
    text
}

fn probability(p: f64) -> String {
    match p {
        p if p < 1e-4 => "<0.0001".to_owned(),
        p if p < 0.01 => format!("{p:.4}"),
        p => format!("{p:.2}"),
    }
}
