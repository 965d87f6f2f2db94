//! Table of a fit for a terminal.
use stochc_experiments::fit::{Fit, Interval, Marginal, Observed, Prediction, Prior, Unit};
use stochc_text::{number, percent_number};

use stochc_text::{TextColumn, TextTable, paragraph};

/// Limit on the posterior's width divided by the prior's width. Above this limit, the data do not
/// constrain the parameter.
const UNINFORMED: f64 = 0.8;

/// Returns the fitted parameters, the predicted times and notes as text. `width` is the width of
/// the terminal \[characters\].
pub fn fit_to_text(fit: &Fit, priors: &[Prior], width: usize) -> String {
    let mut text = numbers(fit, priors).text(width, false);
    text += &format!("\n{}\n", predictions(fit).text(width, false));
    for note in notes(fit) {
        text += &paragraph(&note, width);
    }
    text
}

fn numbers(fit: &Fit, priors: &[Prior]) -> TextTable {
    let column = |header: &str, cell: &dyn Fn(&Marginal, &Prior) -> String| {
        let pairs = fit.numbers.iter().zip(priors);
        TextColumn::figures(header, pairs.map(|(it, prior)| cell(it, prior)).collect())
    };
    let range = |low: f64, high: f64, unit: &str| {
        let text = format!("{} .. {} {unit}", number(low), number(high));
        text.trim_end().to_owned()
    };
    let mut columns = vec![
        column("range", &|it, prior| range(prior.from, prior.to, &it.unit)),
        column("median", &|it, _| {
            format!("{} {}", number(it.median), it.unit)
                .trim_end()
                .to_owned()
        }),
        column("95 % interval", &|it, _| {
            range(it.interval.0, it.interval.1, &it.unit)
        }),
    ];
    let remarks = fit.numbers.iter().map(|it| {
        let remark = match it {
            it if it.is_at_edge => "at an end of its range",
            it if it.width > UNINFORMED => "hardly constrained by the data",
            _ => "",
        };
        remark.to_owned()
    });
    columns.push(TextColumn::words("", remarks.collect()));
    TextTable {
        label: "number".to_owned(),
        labels: fit.numbers.iter().map(|it| it.name.clone()).collect(),
        columns,
        ..TextTable::default()
    }
}

fn predictions(fit: &Fit) -> TextTable {
    let column = |header: &str, cell: &dyn Fn(&Prediction) -> String| {
        TextColumn::figures(header, fit.predictions.iter().map(cell).collect())
    };
    let measured = |of: fn(&Observed) -> String| {
        move |it: &Prediction| it.measurement.observed.as_ref().map_or_else(absent, of)
    };
    let interval = |it: Interval| format!("{} .. {}", number(it.low), number(it.high));
    let shares = |it: Interval| {
        format!(
            "{} .. {} %",
            percent_number(it.low),
            percent_number(it.high)
        )
    };
    let mut columns = vec![
        column("n", &|it| it.measurement.n.to_string()),
        column("mean", &measured(|it| number(it.mean))),
        column("predicted", &|it| interval(it.mean)),
    ];
    if fit.predictions.iter().any(|it| it.sd.is_some()) {
        let sd = |it: &Observed| match it.horizon {
            None => number(it.sd),
            Some(_) => absent(),
        };
        columns.push(column("SD", &measured(sd)));
        columns.push(column("predicted", &|it| {
            it.sd.map_or_else(absent, interval)
        }));
    }
    if has_horizon(fit) {
        let incomplete = |it: &Observed| match it.horizon {
            None => absent(),
            Some(_) => format!("{} %", percent_number(it.incomplete)),
        };
        columns.push(column("incomplete", &measured(incomplete)));
        let predicted = |it: &Prediction| it.incomplete.map_or_else(absent, shares);
        columns.push(column("predicted", &predicted));
    }
    let remarks = fit.predictions.iter().map(remark).collect();
    columns.push(TextColumn::words("", remarks));
    TextTable {
        label: "program".to_owned(),
        labels: (fit.predictions.iter())
            .map(|it| it.measurement.label())
            .collect(),
        columns,
        ..TextTable::default()
    }
}

/// Returns the text of a cell whose value is unknown.
fn absent() -> String {
    "-".to_owned()
}

fn has_horizon(fit: &Fit) -> bool {
    (fit.predictions.iter()).any(|it| it.incomplete.is_some())
}

fn remark(it: &Prediction) -> String {
    let used = match (&it.measurement.observed, it.measurement.is_fitted) {
        (None, _) => Some("not measured"),
        (Some(_), false) => Some("held out"),
        (Some(_), true) => None,
    };
    let until = it
        .measurement
        .horizon()
        .map(|end| format!("up to {}", number(end)));
    let missed = [
        (it.has_mean(), "mean missed"),
        (it.has_sd(), "SD missed"),
        (it.has_incomplete(), "share missed"),
    ];
    let missed = missed.into_iter().filter(|(is_within, _)| !is_within);
    let missed = missed.map(|(_, word)| word.to_owned());
    let parts = used.map(str::to_owned).into_iter();
    parts
        .chain(until)
        .chain(missed)
        .collect::<Vec<_>>()
        .join(", ")
}

fn notes(fit: &Fit) -> Vec<String> {
    let unit = match fit.unit {
        Unit::Ticks => "ticks",
        Unit::Seconds => "seconds",
    };
    let mut notes = vec![format!(
        "Times are in {unit}. Before the fit, all values of a range were equally likely. The predicted intervals contain the \
         mean and the standard deviation of another measurement of n runs with 95~% probability. The fit used {} points \
         with {} runs.",
        fit.points, fit.runs
    )];
    if has_horizon(fit) {
        notes.push(
            "The remark (up to) gives the limit of the times: longer times count as this limit. Incomplete is the share of longer \
             times."
                .to_owned(),
        );
    }
    if fit.stopped > 0 {
        notes.push(format!(
            "{} simulated times are not used, because they are incomplete. Points with more than a tenth of such times are \
             left out.",
            fit.stopped
        ));
    }
    let together: Vec<String> = pairs(fit)
        .into_iter()
        .map(|(i, j, r)| {
            format!(
                "{} and {} ({r:.2})",
                fit.numbers[i].name, fit.numbers[j].name
            )
        })
        .collect();
    if !together.is_empty() {
        notes.push(format!(
            "The data separate these parameters poorly (correlation in brackets): {}.",
            together.join(", ")
        ));
    }
    if fit.numbers.iter().any(|it| it.is_at_edge) {
        notes.push(
            "A parameter is at an end of its range. Its best value may be outside: use a wider range if that is possible.".to_owned(),
        );
    }
    notes
}

/// Returns the strongly correlated pairs of parameters, each with its correlation.
fn pairs(fit: &Fit) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::new();
    for (i, row) in fit.correlations.iter().enumerate() {
        let strong = row
            .iter()
            .enumerate()
            .skip(i + 1)
            .filter(|(_, r)| r.abs() > 0.8);
        found.extend(strong.map(|(j, r)| (i, j, *r)));
    }
    found
}
