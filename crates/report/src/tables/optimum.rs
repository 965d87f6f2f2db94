//! Table of an optimization for a terminal.
use stochc_experiments::fit::Prior;
use stochc_experiments::optimize::{ConfirmedConstraint, OptimalNumber, Optimum};
use stochc_experiments::{Estimate, Verdict};
use stochc_text::{TextColumn, TextTable, number, paragraph};

/// Returns the optimum of each program and notes as text. `width` is the width of the terminal
/// \[characters\].
pub fn optima_to_text(optima: &[Optimum], priors: &[Prior], width: usize) -> String {
    let mut text = String::new();
    for optimum in optima {
        text += &format!("{}\n", numbers(optimum, priors).text(width, false));
    }
    text += &format!("{}\n", objectives(optima).text(width, false));
    if optima.iter().any(|it| !it.constraints.is_empty()) {
        text += &format!("{}\n", constraints(optima).text(width, false));
    }
    for note in notes(optima) {
        text += &paragraph(&note, width);
    }
    text
}

fn numbers(optimum: &Optimum, priors: &[Prior]) -> TextTable {
    let column = |header: &str, cell: &dyn Fn(&OptimalNumber, &Prior) -> String| {
        let pairs = optimum.numbers.iter().zip(priors);
        TextColumn::figures(header, pairs.map(|(it, prior)| cell(it, prior)).collect())
    };
    let with_unit = |text: String, unit: &str| format!("{text} {unit}").trim_end().to_owned();
    let range = |low: f64, high: f64, unit: &str| {
        with_unit(format!("{} .. {}", number(low), number(high)), unit)
    };
    let edge = |it: &OptimalNumber, prior: &Prior| {
        let is_at_end = it.value <= prior.from || it.value >= prior.to;
        if is_at_end { "at an end" } else { "" }
    };
    let remarks = optimum.numbers.iter().zip(priors);
    let remarks = remarks.map(|(it, prior)| edge(it, prior).to_owned());
    let columns = vec![
        column("optimum", &|it, _| {
            with_unit(number(it.value), &it.similar.unit)
        }),
        column("similar", &|it, _| {
            range(
                it.similar.interval.0,
                it.similar.interval.1,
                &it.similar.unit,
            )
        }),
        column("elasticity", &|it, _| {
            it.elasticity.as_ref().map_or("-".to_owned(), interval)
        }),
        TextColumn::words("", remarks.collect()),
    ];
    TextTable {
        label: optimum.program.clone(),
        labels: (optimum.numbers.iter())
            .map(|it| it.similar.name.clone())
            .collect(),
        columns,
        ..TextTable::default()
    }
}

fn interval(it: &Estimate) -> String {
    format!("{} .. {}", number(it.low), number(it.high))
}

/// Returns a value with its interval.
pub(crate) fn estimate_to_text(it: Option<&Estimate>) -> String {
    let value = |it: &Estimate| format!("{} ({})", number(it.value), interval(it));
    it.map_or("-".to_owned(), value)
}

fn objectives(optima: &[Optimum]) -> TextTable {
    let column = |header: &str, cell: &dyn Fn(&Optimum) -> String| {
        TextColumn::figures(header, optima.iter().map(cell).collect())
    };
    TextTable {
        label: "objective at the optimum".to_owned(),
        labels: (optima.iter())
            .map(|it| format!("{}: {}", it.program, it.objective))
            .collect(),
        columns: vec![
            column("predicted", &|it| interval(&it.predicted)),
            column("confirmed", &|it| estimate_to_text(it.confirmed.as_ref())),
            column("runs", &|it| it.runs.to_string()),
        ],
        ..TextTable::default()
    }
}

fn constraints<'a>(optima: &'a [Optimum]) -> TextTable {
    let all = || {
        let each = |of: &'a Optimum| of.constraints.iter().map(move |it| (&*of.program, it));
        optima.iter().flat_map(each)
    };
    let column = |header: &str, cell: &dyn Fn(&ConfirmedConstraint) -> String| {
        TextColumn::figures(header, all().map(|(_, it)| cell(it)).collect())
    };
    let verdicts = all().map(|(_, it)| match it.verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::Undecided => "undecided",
    });
    TextTable {
        label: "constraint at the optimum".to_owned(),
        labels: all()
            .map(|(program, it)| format!("{program}: {}", it.constraint))
            .collect(),
        columns: vec![
            column("predicted", &|it| interval(&it.predicted)),
            column("confirmed", &|it| estimate_to_text(it.confirmed.as_ref())),
            TextColumn::words("", verdicts.map(str::to_owned).collect()),
        ],
        ..TextTable::default()
    }
}

/// Returns a note if the confirmed value is larger than predicted.
fn too_wide(optimum: &Optimum) -> Option<String> {
    let confirmed = optimum.confirmed.as_ref()?;
    if confirmed.low <= optimum.predicted.high {
        return None;
    }
    let best = &optimum.best_simulated;
    let numbers = best.numbers.iter().zip(&optimum.numbers);
    let numbers = numbers.map(|(value, it)| {
        let text = format!("{}={} {}", it.similar.name, number(*value), it.similar.unit);
        text.trim_end().to_owned()
    });
    Some(format!(
        "The confirmed {} of `{}` is larger than predicted, so the ranges are too wide. Use narrower ranges around the point \
         with the smallest value in the search, {}: {} in {} runs.",
        optimum.objective,
        optimum.program,
        numbers.collect::<Vec<_>>().join(", "),
        number(best.value),
        best.runs,
    ))
}

fn notes(optima: &[Optimum]) -> Vec<String> {
    let confirming = optima.first().map_or(0, |it| it.confirming);
    let mut notes = vec![
        format!(
            "Times are in ticks. Intervals are 95 % intervals. Runs is the number of runs of the search. \
             Confirmed is the value in {confirming} other runs with another seed."
        ),
        "Similar values cannot be distinguished from the optimum. Elasticity is the relative change of \
         the objective, divided by the relative change of the parameter."
            .to_owned(),
    ];
    let unexpected = optima.iter().filter(|it| it.constraints.is_empty());
    notes.extend(unexpected.filter_map(too_wide));
    for it in optima.iter().filter(|it| !it.feasible) {
        notes.push(format!(
            "No point of the ranges is predicted to satisfy the constraints of `{}`. This point comes nearest.",
            it.program
        ));
    }
    let mut constraints = optima.iter().flat_map(|it| &it.constraints);
    if constraints.any(|it| it.verdict == Verdict::Undecided) {
        notes.push(
            "A constraint is undecided if the confirming runs cannot show that it holds or fails. More runs \
             (`--confirm`) or a stricter constraint decide."
                .to_owned(),
        );
    }
    let stopped: usize = optima.iter().map(|it| it.stopped).sum();
    if stopped > 0 {
        notes.push(format!(
            "{stopped} runs of the search did not complete. At each point, the first of them counts with the time of \
             --max-ticks, the second with twice this time, and so on."
        ));
    }
    let stopped: usize = optima.iter().map(|it| it.stopped_confirming).sum();
    if stopped > 0 {
        notes.push(format!(
            "{stopped} runs with another seed did not complete. Each counts with the time of --max-ticks."
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use stochc_experiments::fit::Marginal;
    use stochc_experiments::optimize::BestSimulated;

    #[test]
    fn a_confirmed_value_above_the_prediction_has_a_note() {
        let estimate = |value: f64| Estimate {
            value,
            low: 0.9 * value,
            high: 1.1 * value,
        };
        let similar = Marginal {
            name: "bond.pull".to_owned(),
            unit: "N".to_owned(),
            median: 20.0,
            interval: (10.0, 30.0),
            width: 0.5,
            is_at_edge: false,
        };
        let mut optimum = Optimum {
            program: "tower".to_owned(),
            objective: "mean".to_owned(),
            numbers: vec![OptimalNumber {
                value: 20.0,
                similar,
                elasticity: None,
            }],
            predicted: estimate(100.0),
            confirmed: Some(estimate(115.0)),
            constraints: Vec::new(),
            feasible: true,
            best_simulated: BestSimulated {
                numbers: vec![42.5],
                value: 55.0,
                runs: 4,
            },
            points: 50,
            runs: 200,
            confirming: 50,
            stopped: 0,
            stopped_confirming: 0,
        };
        assert_eq!(too_wide(&optimum), None);
        optimum.confirmed = Some(estimate(300.0));
        let note = too_wide(&optimum).unwrap();
        assert!(note.ends_with("bond.pull=42.5 N: 55 in 4 runs."), "{note}");
    }
}
