//! Section about the scene parameters of a sweep and the resulting times.
use stochc_experiments::sweep::{Sweep, SweepPoint, SweptElasticity};
use stochc_text::series;
use stochc_text::{number, percent};

use super::Parts;
use super::common::{figure, mean_cell, show};
use super::parts::ROWS;
use crate::ensemble_report::html::{Html, HtmlCell, code, name};
use crate::figures::sweep as pictures;
use crate::svg::{Drawing, Medium};
use crate::tables::estimate_to_text;

pub(super) fn sweeps(parts: &Parts, out: &mut Html, drawings: &mut Vec<Drawing>) {
    if parts.sweeps.is_empty() {
        return;
    }
    out.heading(2, "sweeps", "Sweeps");
    for (i, sweep) in parts.sweeps.iter().enumerate() {
        out.paragraph(&differences(sweep));
        let prefix = format!("sweep-{}", i + 1);
        let drawn = |medium| pictures(medium, sweep, &prefix);
        let [screen, printed] = [Medium::Screen, parts.surroundings.figures.medium].map(drawn);
        for (screen, printed) in screen.into_iter().zip(printed) {
            let caption = if screen.name.ends_with("-completed") {
                "Dots are shares of the finished runs. Lines are their 95 % confidence intervals."
            } else {
                "Lines are 95 % confidence intervals. ≥ marks lower bounds, because some runs did not \
                 complete."
            };
            let figure = |medium| match medium {
                Medium::Screen => Some(screen.clone()),
                Medium::Print(_) => Some(printed.clone()),
            };
            show(parts, out, drawings, figure, caption, &["sweeps.csv"]);
        }
        table(sweep, out);
        elasticities(sweep, out);
    }
}

fn elasticities(sweep: &Sweep, out: &mut Html) {
    let known = |it: &SweptElasticity| {
        let estimate = estimate_to_text(Some(it.elasticity.as_ref()?));
        let (program, parameter) = (name(&it.program), code(&it.parameter));
        Some(format!("{program}, {parameter}: {estimate}"))
    };
    let known: Vec<String> = sweep.elasticities.iter().filter_map(known).collect();
    if !known.is_empty() {
        out.paragraph(
            "Elasticities of the mean time. An elasticity is the relative change of the mean time, divided by the \
             relative change of the parameter. In brackets is its 95 % confidence interval.",
        );
        out.list("ul", &known);
    }
}

/// Returns a sentence of HTML about the differences between the points of a sweep.
fn differences(sweep: &Sweep) -> String {
    if sweep.axes.is_empty() {
        let settings: Vec<String> = sweep.settings.iter().map(|of| code(of)).collect();
        return format!("These runs differ in {}.", series(&settings, "and"));
    }
    let numbers: Vec<String> = sweep.axes.iter().map(|axis| code(&axis.name)).collect();
    let programs: Vec<String> = sweep.programs().into_iter().map(name).collect();
    let differing = match programs.len() {
        1 => ". They",
        _ => ". Runs of one program",
    };
    format!(
        "These are runs of {}{differing} differ only in {} of its scene.",
        series(&programs, "and"),
        series(&numbers, "and"),
    )
}

fn table(sweep: &Sweep, out: &mut Html) {
    let row = |point: &SweepPoint| {
        let mut cells = vec![HtmlCell::Marked(name(&point.program))];
        let values = point.values.iter();
        cells.extend(values.map(|value| HtmlCell::Number(number(value.value))));
        let time = point.time.as_ref();
        let tick = sweep.tick(point);
        cells.push(mean_cell(time, tick));
        cells.push(figure(time.and_then(|time| time.median), tick));
        cells.push(HtmlCell::Number(format!(
            "{} of {}",
            point.completed,
            point.finished()
        )));
        cells.push(figure(point.time_per_capture, tick));
        let released = point.released.map_or("–".into(), percent);
        cells.push(HtmlCell::Number(released));
        cells
    };
    let rows: Vec<_> = sweep.points.iter().take(ROWS).map(row).collect();
    let seconds = match sweep.points.first().and_then(|point| sweep.tick(point)) {
        Some(_) => ", and below in seconds",
        None => "",
    };
    let caption = format!("Completion time in {}{seconds}", sweep.unit);
    let axes: Vec<String> = sweep.axes.iter().map(|axis| axis.label()).collect();
    let figures = [
        "mean",
        "median",
        "completed",
        "per capture",
        "released blocks",
    ];
    let header: Vec<&str> = (std::iter::once("program"))
        .chain(axes.iter().map(String::as_str))
        .chain(figures)
        .collect();
    out.table(&caption, &header, &rows);
    if sweep.points.len() > ROWS {
        out.note(&format!(
            "The table shows the first {ROWS} of {} points. The data file contains all points.",
            sweep.points.len()
        ));
    }
}
