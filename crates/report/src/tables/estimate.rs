//! Tables of estimates for a terminal.
use stochc_text::{number, percent};

use stochc_runtime::rates::{Interaction, LowerBoundReasons, Times};

use super::rates::{KNOWN_BIAS, first_guess};
use crate::estimate::{CompletionEstimate, Method};
use crate::text::event_labels;
use stochc_text::{TextColumn, TextTable, paragraph};

/// Returns tables of the estimated times of programs and phases. Also lists at most `most` events
/// of each program, those with the largest shares. `width` is the width of the terminal
/// \[characters\].
pub fn estimates_to_text(estimates: &[CompletionEstimate], most: usize, width: usize) -> String {
    let mut text = String::new();
    for (number, estimate) in estimates.iter().enumerate() {
        if number > 0 {
            text.push('\n');
        }
        text += &times(estimate).text(width, false);
        text += &paragraph(&origin(estimate), width);
        text += &lower_bound(estimate.lower_bound, width);
        if most > 0 && !estimate.shares.is_empty() {
            text += &format!("\n{}", shares(estimate, most).text(width, false));
        }
    }
    let is_guess = |it: &&CompletionEstimate| {
        matches!(
            it.method,
            Method::Graph {
                is_first_guess: true,
                ..
            }
        )
    };
    let guesses = estimates.iter().filter(is_guess).count();
    text.push('\n');
    if guesses > 0 {
        text += &paragraph(&first_guess(), width);
    }
    if guesses < estimates.len() {
        text += &paragraph(KNOWN_BIAS, width);
    }
    text
}

/// Returns a paragraph about the method of an estimate and its accuracy.
fn origin(estimate: &CompletionEstimate) -> String {
    let all = estimate.completed + estimate.incomplete;
    let mut text = match (estimate.method, all) {
        (Method::Graph { .. }, 0) => {
            return "There is no estimate, because one capture has no free block left.".to_owned();
        }
        (Method::Graph { interaction, .. }, _) => format!(
            "{all} samples of the dependency graph. {}",
            left_out(interaction)
        ),
        (Method::Runs, _) => format!("{all} runs of the rate model."),
    };
    if estimate.incomplete > 0 {
        text += &format!(
            " {} of them did not complete, so the mean is unknown. The quantiles count them as the slowest ones.",
            estimate.incomplete
        );
    }
    text
}

/// Returns a paragraph about times that are lower bounds. Returns an empty text if `reasons` is
/// empty.
pub fn lower_bound(reasons: LowerBoundReasons, width: usize) -> String {
    if reasons.is_empty() {
        String::new()
    } else {
        paragraph(
            &format!("These times are lower bounds: {}.", reasons.text()),
            width,
        )
    }
}

/// Returns a sentence about the interactions that the sum along a graph ignores, and about the
/// resulting error.
pub fn left_out(interaction: Interaction) -> String {
    let mut meaning = interaction.meaning().to_owned();
    meaning[..1].make_ascii_uppercase();
    let error = percent(interaction.error());
    format!(
        "{meaning}. In such programs, means differed by at most {error} from runs of the rate model (`stochc estimate --runs N`)."
    )
}

/// Statistic of times with its half-width. `None` if unknown.
type Figure = (Option<f64>, Option<f64>);

fn times(estimate: &CompletionEstimate) -> TextTable {
    let total = std::iter::once((format!("{}, ticks", estimate.program), estimate.total));
    // A program with a single phase needs no row for it.
    let phases = estimate.phases.iter().filter(|_| estimate.phases.len() > 1);
    let phases = phases.map(|phase| (format!("  {}", phase.name), phase.times));
    let rows: Vec<(String, Option<Times>)> = total.chain(phases).collect();
    let column = |header: &str, value: &dyn Fn(&Times) -> Figure| {
        let cell = |times: &Option<Times>| match times.as_ref().map(value) {
            None => "?".to_owned(),
            Some((None, _)) => "-".to_owned(),
            Some((Some(value), Some(half))) if half > 0.0 => {
                format!("{} ± {}", number(value.round()), number(half.round()))
            }
            Some((Some(value), _)) => number(value.round()),
        };
        TextColumn::figures(header, rows.iter().map(|(_, times)| cell(times)).collect())
    };
    TextTable {
        label: label(estimate).to_owned(),
        columns: vec![
            column("mean", &|it| (it.mean, it.half_width)),
            column("10 %", &|it| (it.p10, it.p10_half_width)),
            column("median", &|it| (it.median, it.median_half_width)),
            column("90 %", &|it| (it.p90, it.p90_half_width)),
        ],
        labels: rows.iter().map(|(name, _)| name.clone()).collect(),
        ..TextTable::default()
    }
}

/// Returns the header of the first column, which describes the kind of times.
fn label(estimate: &CompletionEstimate) -> &'static str {
    let is_calibrated = !matches!(
        estimate.method,
        Method::Graph {
            is_first_guess: true,
            ..
        }
    );
    match (is_calibrated, estimate.lower_bound.is_empty()) {
        (true, true) => "estimate",
        (true, false) => "lower bound",
        (false, true) => "uncalibrated estimate",
        (false, false) => "uncalibrated lower bound",
    }
}

fn shares(estimate: &CompletionEstimate, most: usize) -> TextTable {
    let shown = &estimate.shares[..most.min(estimate.shares.len())];
    let all = estimate.shares.iter().map(|share| share.event.as_str());
    let labelled = shown.iter().map(|share| {
        (
            share.event.as_str(),
            share.event.clone(),
            share.phase.as_str(),
        )
    });
    TextTable {
        label: "waiting for this capture only".to_owned(),
        labels: event_labels(all, labelled),
        columns: vec![TextColumn::figures(
            "of the time",
            shown.iter().map(|share| percent(share.share)).collect(),
        )],
        ..TextTable::default()
    }
}
