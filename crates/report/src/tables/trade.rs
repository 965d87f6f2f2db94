//! Table of a trade for a terminal.
use crate::text::relative;
use stochc_experiments::trade::{
    CLOSE, CandidateResult, Convergence, ProgramResult, Reference, Trade, Verdict,
};
use stochc_text::{Tick, percent, ratio, seconds, visible};

use super::comparison::ticks;
use stochc_text::{TextColumn, TextTable, paragraph};

/// Text of a cell whose value is unknown.
const NONE: &str = "-";

/// Mark before a bias that compares restricted means, which count times only up to a horizon.
pub(crate) const RESTRICTED: &str = "* ";

/// Headers of the columns with numbers.
const HEADER: [&str; 7] = [
    "CPU/run", "ratio", "n", "mean", "bias", "incompl.", "failed",
];

struct TradeRow {
    label: String,
    cells: Vec<String>,
    mark: &'static str,
    /// Remark after the last column.
    remark: String,
    /// Whether the row is red in colour output.
    wrong: bool,
}

/// Returns a table for each program, the order of the programs, and the recommendation.
///
/// `width` is the width of the terminal for sentences \[characters\]. With `colour`, errors are
/// red.
pub fn trade_to_text(trade: &Trade, width: usize, colour: bool) -> String {
    let mut text = String::new();
    let mut cells = trade
        .candidates
        .iter()
        .flat_map(|candidate| &candidate.programs);
    let any_failed = cells.any(|cell| cell.failed > 0);
    for (i, program) in trade.programs.iter().enumerate() {
        text += &format!("{}\n", visible(&program.name));
        let candidates = trade.candidates.iter().enumerate();
        let run = candidates.filter(|(_, candidate)| candidate.programs[i].runs > 0);
        let lines: Vec<TradeRow> = run
            .map(|(n, candidate)| line(trade, n, candidate, i))
            .collect();
        let header = &HEADER[..HEADER.len() - usize::from(!any_failed)];
        text += &table(header, &lines).text(width, colour);
        text.push('\n');
    }
    if trade.programs.len() > 1 && trade.reference.is_some() {
        text += &ranking(trade, width, colour);
        text.push('\n');
    }
    for note in notes(trade) {
        text += &paragraph(&note, width);
    }
    text.push('\n');
    text += &paragraph(&trade.advice, width);
    text
}

fn line(trade: &Trade, number: usize, candidate: &CandidateResult, program: usize) -> TradeRow {
    let cell = &candidate.programs[program];
    let itself = trade
        .reference
        .as_ref()
        .is_some_and(|r| r.candidate == number);
    let mark = match candidate.reversed {
        _ if itself => "reference",
        true => "REVERSED",
        false if candidate.front => "front",
        false => "",
    };
    TradeRow {
        label: label(number, candidate),
        mark,
        cells: figures(trade, cell, itself, program).to_vec(),
        remark: String::new(),
        wrong: candidate.reversed,
    }
}

fn figures(trade: &Trade, cell: &ProgramResult, itself: bool, program: usize) -> [String; 7] {
    let or_none = |text: Option<String>| text.unwrap_or(NONE.to_owned());
    let reference = trade.reference_candidate();
    let whole = reference.and_then(|candidate| candidate.programs[program].cost);
    let ratio = cell
        .cost
        .zip(whole)
        .map(|(cost, whole)| self::ratio(cost / whole));
    let bound = mark_if(cell.horizon.is_some(), "≥ ");
    let tick = Tick(trade.programs[program].tick);
    let mean = cell.mean.map(|mean| {
        let half = cell.half_width.map(|half| format!(" ± {}", ticks(half)));
        let suffix = tick.beside_interval(mean, cell.half_width);
        format!("{bound}{}{}{suffix}", ticks(mean), half.unwrap_or_default())
    });
    let blank = |text: Option<String>| if itself { String::new() } else { or_none(text) };
    [
        or_none(cell.cost.map(seconds)),
        or_none(ratio),
        cell.runs.to_string(),
        or_none(mean),
        blank(cell.bias.as_ref().map(|bias| {
            format!(
                "{}{}",
                mark_if(bias.horizon.is_some(), RESTRICTED),
                relative(bias)
            )
        })),
        (cell.timed_out + cell.censored).to_string(),
        cell.failed.to_string(),
    ]
}

fn mark_if(is_marked: bool, mark: &str) -> &str {
    if is_marked { mark } else { "" }
}

/// Returns text about the order of the programs with each setting.
fn ranking(trade: &Trade, width: usize, colour: bool) -> String {
    let pairs = trade
        .reference_candidate()
        .map_or(&[][..], |candidate| &candidate.ranking);
    let ordered = pairs
        .iter()
        .filter(|pair| pair.verdict != Verdict::Unordered);
    let ordered: Vec<String> = ordered
        .map(|ranked| pair(trade, ranked.first, ranked.second))
        .collect();
    if ordered.is_empty() {
        return "No two programs differ significantly in the runs of the reference, so there is no order to compare.\n"
            .to_owned();
    }
    let mut text = format!(
        "Order of the means in the reference: {}\n",
        ordered.join(", ")
    );
    let count = |candidate: &CandidateResult, verdict| {
        let pairs = candidate
            .ranking
            .iter()
            .filter(|pair| pair.verdict == verdict);
        pairs.count().to_string()
    };
    let candidates = trade
        .candidates
        .iter()
        .enumerate()
        .filter(|(_, candidate)| !candidate.ranking.is_empty());
    let lines: Vec<TradeRow> = candidates
        .map(|(number, candidate)| TradeRow {
            label: label(number, candidate),
            cells: vec![
                count(candidate, Verdict::Preserved),
                count(candidate, Verdict::Unclear),
                count(candidate, Verdict::Reversed),
            ],
            mark: "",
            remark: if !candidate.reversed {
                String::new()
            } else {
                let pairs = candidate.reversals();
                let pairs = pairs.map(|ranked| pair(trade, ranked.first, ranked.second));
                format!("REVERSED: {}", pairs.collect::<Vec<_>>().join(", "))
            },
            wrong: candidate.reversed,
        })
        .collect();
    text += &table(&["preserved", "unclear", "reversed"], &lines).text(width, colour);
    text
}

fn pair(trade: &Trade, first: usize, second: usize) -> String {
    format!(
        "{} < {}",
        trade.programs[first].name, trade.programs[second].name
    )
}

/// Returns the notes that the values of the tables require.
fn notes(trade: &Trade) -> Vec<String> {
    let mut notes = vec![
        "A setting is a model with its substeps, and all options that differ from their defaults. CPU/run is the median CPU \
         time of a run. ratio is this time, divided by that of the reference. Means are in ticks, with seconds in brackets. \
         n is the number of runs. bias is the difference from the mean of the reference, as a fraction of it. ±~is the \
         95~% confidence interval. front marks Pareto-optimal settings: no cheaper setting is known to be as accurate."
            .to_owned(),
    ];
    if let (Some(reference), Some(candidate)) = (&trade.reference, trade.reference_candidate()) {
        let last = reference.doublings.last();
        let changes = last.iter().flat_map(|last| &last.changes);
        let changes = changes.map(|change| match change {
            Some(change) => relative(change),
            None => "unknown".to_owned(),
        });
        let changes: Vec<String> = changes.collect();
        notes.push(format!(
            "Reference: `{}`, the finest setting that was measured. {}",
            candidate.options,
            convergence(reference, &changes.join(", "))
        ));
    }
    let cells = || {
        trade
            .candidates
            .iter()
            .flat_map(|candidate| &candidate.programs)
    };
    if cells().any(|cell| cell.timed_out + cell.censored > 0) {
        let limit = trade
            .max_ticks
            .map_or("none".to_owned(), |it| it.to_string());
        notes.push(format!(
            "incompl. counts runs that timed out or reached the limit of ticks ({limit}). Means with ≥ are lower bounds: the \
             mean of min(time, last observed time). Biases with * compare means of min(time, h), and do not \
             cover longer times. h is the last time that both samples cover."
        ));
    }
    if cells().any(|cell| cell.failed > 0) {
        notes.push(
            "failed counts runs with an error of the physics, or with a broken bond. Runs with an error count only in the cost."
                .into(),
        );
    }
    notes
}

/// Returns a table of settings. Its rows may lack values.
fn table(header: &[&str], lines: &[TradeRow]) -> TextTable {
    let columns = header.iter().enumerate().map(|(i, header)| {
        let cell = |line: &TradeRow| line.cells.get(i).cloned().unwrap_or_default();
        TextColumn::figures(*header, lines.iter().map(cell).collect())
    });
    let marks = lines.iter().map(|line| line.mark.to_owned()).collect();
    let remarks = lines.iter().map(|line| line.remark.clone()).collect();
    TextTable {
        label: " #  setting".to_owned(),
        labels: lines.iter().map(|line| line.label.clone()).collect(),
        columns: [TextColumn::words("", marks)]
            .into_iter()
            .chain(columns)
            .chain([TextColumn::words("", remarks)])
            .collect(),
        red: lines.iter().map(|line| line.wrong).collect(),
    }
}

/// Returns the number and the name of a setting. Figures show the same number.
fn label(number: usize, setting: &CandidateResult) -> String {
    format!("{:>2}  {}", number + 1, setting.name)
}

/// Returns a sentence about the convergence of the reference. `changes` describes the effect of its
/// last doubling of substeps.
fn convergence(reference: &Reference, changes: &str) -> String {
    let Some(last) = reference.doublings.last() else {
        return "It is undecided whether it has converged: no other number of substeps was measured."
            .to_owned();
    };
    let (from, to) = (last.from, last.to);
    match (reference.convergence, reference.bound) {
        (Convergence::Converged, Some(bound)) => format!(
            "It has converged within {}. The last doubling of its substeps, from {from} to {to}, changed no \
             mean by more than {}, including the confidence intervals: {changes}.",
            percent(CLOSE),
            percent(bound)
        ),
        (Convergence::NotConverged, _) => format!(
            "It has NOT CONVERGED: one of the last two doublings of its substeps changed a mean significantly. Changes \
             by the last one, from {from} to {to}: {changes}."
        ),
        (_, bound) => {
            let open = match bound {
                _ if reference.doublings.len() < 2 => {
                    "only one doubling of its substeps was measured".to_owned()
                }
                Some(bound) if last.censored.iter().any(|&runs| runs > 0) => format!(
                    "the limit of ticks has stopped {} runs of its last doubling. Up to that limit, times changed by at \
                     most {}, but the change of longer times is unknown",
                    last.censored.iter().sum::<usize>(),
                    percent(bound)
                ),
                Some(bound) => format!(
                    "its last doubling may have changed a mean by up to {}. More runs would \
                     decide",
                    percent(bound)
                ),
                None => "there are too few runs for an interval".to_owned(),
            };
            format!(
                "It is undecided whether it has converged: {open}. Changes by the last doubling, from {from} to \
                 {to} substeps: {changes}."
            )
        }
    }
}
