//! What several parts of the page say alike.
use super::{Parts, SIGNIFICANT};
use crate::ensemble::Time;
use crate::figures::{Drawing, Tick, escaped, number};
use crate::report::address;
use crate::report::contrast::{Clock, Contrast, Method, Verdict};
use crate::report::html::{Cell, Html, name};

pub(super) fn link(folder: &str, file: &str) -> String {
    format!(
        "<a href=\"{}/{file}\">{file}</a>",
        escaped(&address(folder))
    )
}

/// Puts a figure on the page, with links to its data.
pub(super) fn show(
    parts: &Parts,
    out: &mut Html,
    drawings: &mut Vec<Drawing>,
    figure: Option<Drawing>,
    caption: &str,
    data: &[&str],
) {
    let Some(figure) = figure else {
        return;
    };
    let folder = parts.surroundings.folder;
    let svg = format!("{}.svg", figure.name);
    let links: Vec<String> = std::iter::once(svg.as_str())
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
    drawings.push(figure);
}

pub(super) fn sentence(parts: &Parts, contrast: &Contrast) -> String {
    let label = |i: usize| name(&parts.subjects[i].label);
    let (first, second) = (label(contrast.first), label(contrast.second));
    match &contrast.verdict {
        Verdict::Same => format!("{first} and {second} are the same runs."),
        Verdict::Unknown => {
            format!("{first} and {second}: too few runs, or no spread, to tell them apart.")
        }
        Verdict::Known {
            difference,
            half_width,
            corrected,
            ..
        } => {
            let p = match probability(*corrected) {
                p if p.starts_with('<') => format!("p {p}"),
                p => format!("p = {p}"),
            };
            let figures = format!(
                "{} ± {} {} ({p})",
                number(difference.abs()),
                number(*half_width),
                parts.clock.unit()
            );
            match (*corrected < SIGNIFICANT, *difference > 0.0) {
                (false, _) => format!(
                    "These runs show no difference between {first} and {second}: {figures}."
                ),
                (true, true) => format!("{first} takes longer than {second} by {figures}."),
                (true, false) => format!("{second} takes longer than {first} by {figures}."),
            }
        }
    }
}

/// The clock of all programs where times are in ticks; `None`: they are in seconds.
pub(super) fn tick(parts: &Parts) -> Option<Tick> {
    match parts.clock {
        Clock::Ticks => Some(parts.subjects.first()?.tick()),
        Clock::Seconds => None,
    }
}

/// A figure, and below it the same in seconds where it is in ticks.
pub(super) fn figure(value: Option<f64>, tick: Option<Tick>) -> Cell {
    let Some(value) = value else {
        return Cell::Number("–".into());
    };
    let seconds = tick.map_or(String::new(), |tick| format!("\n{}", tick.seconds(value)));
    Cell::Number(number(value) + &seconds)
}

/// A mean with its interval, and below it the same in seconds where it is in ticks.
pub(super) fn mean_cell(time: Option<&Time>, tick: Option<Tick>) -> Cell {
    let Some(time) = time else {
        return Cell::Number("–".into());
    };
    let seconds = tick.map(|tick| tick.interval(time.mean, time.half_width));
    let seconds = seconds.map_or(String::new(), |seconds| format!("\n{seconds}"));
    Cell::Number(mean(time) + &seconds)
}

/// Mean, median, SD, CV, and the ends; with `tick` in seconds as well.
pub(super) fn figures(time: Option<&Time>, tick: Option<Tick>) -> Vec<Cell> {
    let figure = |of: fn(&Time) -> Option<f64>| figure(time.and_then(of), tick);
    vec![
        mean_cell(time, tick),
        figure(|time| time.median),
        figure(|time| time.sd),
        Cell::Number(coefficient(time)),
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
    match time.censored {
        0 => format!("{}{half}", number(time.mean)),
        _ => format!("≥ {}{half}", number(time.mean)),
    }
}

pub(super) fn probability(p: f64) -> String {
    match p {
        p if p < 1e-4 => "< 0.0001".to_owned(),
        p if p < 0.01 => format!("{p:.4}"),
        p if p < 0.1 => format!("{p:.3}"),
        p => format!("{p:.2}"),
    }
}

pub(super) fn method_text(method: Method, unit: &str) -> String {
    match method {
        Method::Paired { n } => format!("paired t, {n} pairs"),
        Method::Welch => "Welch's t".to_owned(),
        Method::LogRank { horizon } => {
            format!("log-rank; means to {} {unit}", number(horizon))
        }
    }
}

/// A file inside a folder, as a path to type.
pub(super) fn inside(folder: &str, file: &str) -> String {
    format!("{}/{file}", folder.trim_end_matches('/'))
}

/// Text of several lines, whose breaks and tabs are kept.
pub(super) fn lines(text: &str) -> String {
    let lines: Vec<String> = text
        .lines()
        .map(|line| escaped(&line.replace('\t', "    ")))
        .collect();
    lines.join("\n")
}
