//! What was varied, and what became of the times.
use super::common::{mean, show};
use super::{Parts, ROWS};
use crate::figures::{Drawing, number, percent};
use crate::report::html::{Cell, Html, code, name};
use crate::sweep::{Point, Sweep, pictures};

pub(super) fn sweeps(parts: &Parts, out: &mut Html, drawings: &mut Vec<Drawing>) {
    if parts.sweeps.is_empty() {
        return;
    }
    out.heading(2, "sweeps", "What was varied");
    for (i, sweep) in parts.sweeps.iter().enumerate() {
        let numbers: Vec<String> = sweep.axes.iter().map(|axis| code(&axis.of)).collect();
        out.paragraph(&format!(
            "These programs differ in nothing but {} of their scenes.",
            numbers.join(", ")
        ));
        for figure in pictures(sweep, &format!("sweep-{}", i + 1)) {
            let caption = match figure.name.ends_with("-completed") {
                true => "Dots are parts of the finished runs, lines their 95 % intervals.",
                false => {
                    "With 95 % intervals; ≥ a lower bound, because runs were stopped before they \
                     completed."
                }
            };
            show(parts, out, drawings, Some(figure), caption, &["sweeps.csv"]);
        }
        table(sweep, out);
    }
}

fn table(sweep: &Sweep, out: &mut Html) {
    let maybe = |value: Option<f64>| Cell::Number(value.map_or("–".into(), number));
    let row = |point: &Point| {
        let mut cells = vec![Cell::Marked(name(&point.program))];
        let values = point.values.iter();
        cells.extend(values.map(|value| Cell::Number(number(value.value))));
        let time = point.time.as_ref();
        cells.push(Cell::Number(time.map_or("–".into(), mean)));
        cells.push(maybe(time.and_then(|time| time.median)));
        cells.push(Cell::Number(format!(
            "{} of {}",
            point.completed,
            point.finished()
        )));
        cells.push(maybe(point.time_per_capture));
        let released = point.released.map_or("–".into(), percent);
        cells.push(Cell::Number(released));
        cells
    };
    let rows: Vec<_> = sweep.points.iter().take(ROWS).map(row).collect();
    let caption = format!("Time to completion in {}", sweep.unit);
    let axes: Vec<String> = sweep.axes.iter().map(|axis| axis.label()).collect();
    let figures = [
        "mean",
        "median",
        "completed",
        "per capture",
        "released before",
    ];
    let header: Vec<&str> = (std::iter::once("program"))
        .chain(axes.iter().map(String::as_str))
        .chain(figures)
        .collect();
    out.table(&caption, &header, &rows);
    if sweep.points.len() > ROWS {
        out.note(&format!(
            "The first {ROWS} of {} points; the data file has all.",
            sweep.points.len()
        ));
    }
}
