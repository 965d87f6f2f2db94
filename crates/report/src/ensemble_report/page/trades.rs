//! Section about cost and accuracy of the settings of a sweep.
use crate::text::relative;
use stochc_experiments::trade::{CandidateResult, Trade};
use stochc_text::{escaped, percent, ratio, seconds};

use super::Parts;
use super::common::show;
use crate::ensemble_report::html::{Html, HtmlCell, code};
use crate::figures::trade as picture;
use crate::svg::Drawing;

/// Adds the figure, table and recommendation of each trade.
pub(super) fn trades(parts: &Parts, out: &mut Html, drawings: &mut Vec<Drawing>) {
    if parts.trades.is_empty() {
        return;
    }
    out.heading(2, "trades", "Speed against accuracy");
    for (i, trade) in parts.trades.iter().enumerate() {
        let figure = |medium| {
            let mut drawing = picture(medium, trade);
            drawing.name = format!("trade-{}", i + 1);
            Some(drawing)
        };
        let caption = "Each mark is a setting with its bias and the 95 % confidence interval.";
        show(parts, out, drawings, figure, caption, &[]);
        table(trade, out);
        out.paragraph(&escaped(&trade.advice));
    }
}

fn table(trade: &Trade, out: &mut Html) {
    let reference = trade.reference.as_ref().map(|it| it.candidate);
    let number = |text: Option<String>| HtmlCell::Number(text.unwrap_or_else(|| "–".to_owned()));
    let row = |(i, candidate): (usize, &CandidateResult)| {
        let verdict = match candidate.reversed {
            _ if reference == Some(i) => "reference",
            true => "reverses an order",
            false if candidate.front => "Pareto-optimal",
            false => "",
        };
        vec![
            HtmlCell::Number((i + 1).to_string()),
            HtmlCell::Marked(code(&candidate.options)),
            number(candidate.cost.map(seconds)),
            number(candidate.cost_ratio.map(ratio)),
            number(candidate.worst.as_ref().map(relative)),
            number(candidate.bound.map(percent)),
            HtmlCell::Plain(verdict.to_owned()),
        ]
    };
    let rows: Vec<_> = trade.candidates.iter().enumerate().map(row).collect();
    out.table(
        "CPU time of a run, and the largest bias of any program, relative to the reference",
        &["", "setting", "CPU/run", "ratio", "bias", "bound", ""],
        &rows,
    );
}
