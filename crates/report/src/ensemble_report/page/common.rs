//! Parts that several sections of the page use.
use stochc_experiments::{PairwiseResult, PairwiseTest, Time, TimeUnit};
use stochc_files::address::address;
use stochc_text::{Tick, escaped, number};

use super::Parts;
use crate::ensemble_report::html::{Html, HtmlCell, name};
use crate::svg::{Drawing, Medium};
use crate::text::sentence as in_words;

pub(super) fn link(folder: &str, file: &str) -> String {
    format!(
        "<a href=\"{}/{file}\">{file}</a>",
        escaped(&address(folder))
    )
}

/// Adds a figure with links to its data. Also adds its version for print to `drawings`. Returns
/// whether there is a figure.
pub(super) fn show(
    parts: &Parts,
    out: &mut Html,
    drawings: &mut Vec<Drawing>,
    figure: impl Fn(Medium) -> Option<Drawing>,
    caption: &str,
    data: &[&str],
) -> bool {
    let Some(printed) = figure(parts.surroundings.figures.medium) else {
        return false;
    };
    let figure = match parts.surroundings.figures.medium {
        Medium::Screen => printed.clone(),
        Medium::Print(_) => match figure(Medium::Screen) {
            Some(figure) => figure,
            None => return false,
        },
    };
    let folder = parts.surroundings.folder;
    let files = parts.surroundings.figures.names(&printed);
    let links: Vec<String> = (files.iter().map(String::as_str))
        .chain(data.iter().copied())
        .map(|file| link(folder, file))
        .collect();
    out.raw(&format!(
        "<figure>\n<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"{}\">\n{}</div>\n\
         <figcaption><strong>{}.</strong> {caption} Files: {}.</figcaption>\n</figure>\n",
        escaped(&figure.title),
        figure.inline("figure-"),
        name(&figure.title),
        links.join(", ")
    ));
    drawings.push(printed);
    true
}

/// Returns a sentence of HTML about the comparison of two programs.
pub(super) fn sentence(parts: &Parts, contrast: &PairwiseTest) -> String {
    // Placeholder characters. They are later replaced by names in HTML.
    const NAMES: [&str; 2] = ["\u{e000}", "\u{e001}"];
    let is_tested = |it: &&PairwiseTest| matches!(it.verdict, PairwiseResult::Known(_));
    let tested = parts.pairwise_tests.iter().filter(is_tested).count();
    let sentence = in_words(NAMES, &contrast.verdict, parts.clock.unit(), tested);
    let mut sentence = escaped(&sentence.replace('~', "\u{a0}"));
    for (sign, i) in NAMES.into_iter().zip([contrast.first, contrast.second]) {
        sentence = sentence.replace(sign, &name(&parts.subjects[i].label));
    }
    sentence
}

/// Returns the length of a tick if times on the page are in ticks. Returns `None` if they are in
/// seconds.
pub(super) fn tick(parts: &Parts) -> Option<Tick> {
    match parts.clock {
        TimeUnit::Ticks => Some(parts.subjects.first()?.tick()),
        TimeUnit::Seconds => None,
    }
}

/// Returns a table cell with a time. If `tick` is given, the time is in ticks, with the same time
/// in seconds below.
pub(super) fn figure(value: Option<f64>, tick: Option<Tick>) -> HtmlCell {
    let Some(value) = value else {
        return HtmlCell::Number("–".into());
    };
    let seconds = tick.map_or(String::new(), |tick| format!("\n{}", tick.seconds(value)));
    HtmlCell::Number(number(value) + &seconds)
}

/// Returns a table cell with a mean and its interval. If `tick` is given, the mean is in ticks,
/// with the same mean in seconds below.
pub(super) fn mean_cell(time: Option<&Time>, tick: Option<Tick>) -> HtmlCell {
    let Some(time) = time else {
        return HtmlCell::Number("–".into());
    };
    let seconds = tick.map(|tick| tick.interval(time.mean, time.half_width));
    let seconds = seconds.map_or(String::new(), |seconds| {
        format!("\n{}{seconds}", bound(time))
    });
    HtmlCell::Number(mean(time) + &seconds)
}

/// Returns table cells with the mean, median, SD, CV, minimum and maximum. If `tick` is given,
/// times are in ticks, with seconds below.
pub(super) fn figures(time: Option<&Time>, tick: Option<Tick>) -> Vec<HtmlCell> {
    let figure = |of: fn(&Time) -> Option<f64>| figure(time.and_then(of), tick);
    vec![
        mean_cell(time, tick),
        figure(|time| time.median),
        figure(|time| time.sd),
        HtmlCell::Number(coefficient(time)),
        figure(|time| time.min),
        figure(|time| time.max),
    ]
}

pub(super) fn coefficient(time: Option<&Time>) -> String {
    let cv = time.and_then(|time| time.cv);
    cv.map_or("–".into(), |cv| format!("{cv:.2}"))
}

pub(super) fn mean(time: &Time) -> String {
    let half = match time.half_width {
        Some(half) => format!(" ± {}", number(half)),
        None => String::new(),
    };
    format!("{}{}{half}", bound(time), number(time.mean))
}

/// Returns the sign `≥` if a time is a lower bound. Otherwise returns an empty text.
pub(super) fn bound(time: &Time) -> &'static str {
    if time.incomplete > 0 { "≥ " } else { "" }
}

/// Returns text of several lines as HTML. Preserves line breaks and tabs.
pub(super) fn lines(text: &str) -> String {
    let lines: Vec<String> = text
        .lines()
        .map(|line| escaped(&line.replace('\t', "    ")))
        .collect();
    lines.join("\n")
}
