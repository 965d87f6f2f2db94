//! Output of `check --cost`.
use serde_json::{Value, json};
use stochc_compiler::diagnostic::Code;
use stochc_compiler::{MAX_ESTIMATED, Program, Symbols};
use stochc_ir::JamRisk;
use stochc_ir::scene::Scene;
use stochc_report::tables::{KNOWN_BIAS, first_guess, left_out, lower_bound};
use stochc_report::text::event_labels;
use stochc_runtime::rates::{CaptureCost, Cost, PhaseCost, Rates, Times};
use stochc_runtime::world::SceneError;
use stochc_runtime::world::rate::RateWorld;
use stochc_text::{TextColumn, TextTable, paragraph};
use stochc_text::{number, percent};

use super::super::terminal::output_width;

/// Returns a table of phases, and a table of the captures that dominate their durations. Returns an
/// empty text without `--cost`.
pub fn costs(program: &Program, symbols: &Symbols, most: Option<usize>, rates: &[Rates]) -> String {
    let Some(most) = most.filter(|_| !program.plan.events.is_empty()) else {
        return String::new();
    };
    let rates = (program.scene.as_ref()).and_then(|scene| Rates::known_or_guessed(rates, scene));
    let rates = rates.as_deref();
    let is_guess = rates.is_some_and(Rates::is_guess);
    program.estimate(rates).map_or(String::new(), |cost| {
        table(program, symbols, &cost, is_guess, most)
    })
}

/// Returns the data of `--cost` as JSON. Returns null for an aggregate.
pub fn cost_json(program: &Program, symbols: &Symbols, most: usize, rates: &[Rates]) -> Value {
    let rates = (program.scene.as_ref()).and_then(|scene| Rates::known_or_guessed(rates, scene));
    let rates = rates.as_deref();
    let cost = if program.plan.events.is_empty() {
        None
    } else {
        program.estimate(rates)
    };
    let Some(cost) = cost else {
        return Value::Null;
    };
    let plan = &program.plan;
    let phases = plan.phases.iter().zip(&cost.phases);
    let phases = phases.filter(|(phase, _)| !phase.pre_attached).map(|(phase, cost)| {
        json!({ "name": phase.name, "depth": cost.depth, "width": cost.width, "times": cost.times })
    });
    let captures = cost.captures.iter().take(most).map(|it| {
        json!({
            "event": plan.describe(it.event, symbols),
            "phase": plan.phase_name(it.event),
            "share": it.share,
            "wait": it.wait,
        })
    });
    json!({
        "lower_bound": cost.lower_bound,
        "total": cost.total,
        "phases": phases.collect::<Vec<_>>(),
        "captures": captures.collect::<Vec<_>>(),
        "is_first_guess": rates.is_some_and(Rates::is_guess),
        "reason": cost.total.is_none().then(|| no_times(program, &cost)),
    })
}

/// Returns a line with the expected duration of a program, or with the reason why it is unknown.
/// Empty for a program without captures.
pub fn summed_up(program: &Program, rates: &[Rates]) -> String {
    let unknown = |reason: &str| format!("  no estimate: {reason}\n");
    let Some(scene) = &program.scene else {
        return String::new();
    };
    if let Some(what) = unsupported(program, scene) {
        return unknown(&format!(
            "the rate model does not support {what}; measure times with `stochc simulate`"
        ));
    }
    if program.plan.events.len() > MAX_ESTIMATED {
        let most = number(MAX_ESTIMATED as f64);
        return unknown(&format!("more than {most} events; run `stochc estimate`"));
    }
    let Some(rates) = Rates::known(rates, scene) else {
        let rough = Rates::known_or_guessed(rates, scene).map_or(
            "measure it",
            |_| "see `--cost` for an uncalibrated one, or measure it",
        );
        return unknown(&format!(
            "scene `{}` has not been calibrated; {rough} with `stochc calibrate`",
            scene.name
        ));
    };
    if !program.jam_risks.is_empty() {
        let risks = program.jam_risks.iter().map(|risk| match risk {
            JamRisk::TightApproach => Code::TightApproach.name(),
            JamRisk::CrowdedCaptures => Code::CrowdedCaptures.name(),
        });
        let risks: Vec<&str> = risks.collect();
        return unknown(&format!(
            "blocks may jam ({}); measure times with `stochc simulate`",
            risks.join(", ")
        ));
    }
    let Some(cost) = program.estimate(Some(rates)) else {
        return String::new();
    };
    let never = stopped(&cost).map(percent);
    let total = match (cost.total, &never) {
        (Some(total), _) if total.mean != Some(0.0) => total,
        (None, None) => return unknown("one capture has no free block left"),
        (None, Some(never)) => {
            return format!("  estimate: a phase reaches its timeout in {never} of all runs\n");
        }
        _ => return String::new(),
    };
    let never = never.map_or(String::new(), |never| format!(" ({never} never complete)"));
    let takes = total.in_words(cost.lower_bound);
    let reasons = if cost.lower_bound.is_empty() {
        String::new()
    } else {
        format!(": {}", cost.lower_bound.text())
    };
    format!("  estimate: {takes}{never}{reasons}; details: `--cost`\n")
}

/// Returns a feature of a program or its scene that the rate model does not support. Returns `None`
/// if it supports all.
fn unsupported(program: &Program, scene: &Scene) -> Option<&'static str> {
    if program.plan.aggregate.is_some() {
        return Some("aggregates");
    }
    match RateWorld::unsupported(scene)? {
        SceneError::NotInModel { what, .. } => Some(what),
        _ => None,
    }
}

/// Returns the fraction of samples that ended at the timeout of a phase. Returns `None` if no
/// sample did.
fn stopped(cost: &Cost) -> Option<f64> {
    let stopped = cost.stopped();
    (stopped > 0).then(|| stopped as f64 / cost.draws.len() as f64)
}

fn table(program: &Program, symbols: &Symbols, cost: &Cost, is_guess: bool, most: usize) -> String {
    let mut text = by_phase(program, cost).text(usize::MAX, false);
    if !cost.captures.is_empty() {
        text += "\n";
        text += &by_capture(program, symbols, cost, most).text(usize::MAX, false);
        let all = cost.captures.len();
        if all > most {
            text += &format!("and {} more; `--cost {all}` shows them\n", all - most);
        }
    }
    text += "\n";
    let width = output_width().saturating_sub(2);
    text += &paragraph(SERIAL_AND_PARALLEL, width);
    match cost.total {
        Some(_) => {
            text += &paragraph(SHARES, width);
            text += &lower_bound(cost.lower_bound, width);
            text += &paragraph(&left_out(cost.interaction), width);
            if let Some(stopped) = stopped(cost) {
                text += &paragraph(
                    &format!(
                        "In {} of the samples, a phase reached its timeout. These never complete, so the mean is unknown. The \
                         quantiles count them as the slowest.",
                        percent(stopped)
                    ),
                    width,
                );
            }
            text += &if is_guess {
                paragraph(&first_guess(), width)
            } else {
                paragraph(KNOWN_BIAS, width)
            };
        }
        None => text += &paragraph(&no_times(program, cost), width),
    }
    let indented = text.lines().map(|line| match line {
        "" => "\n".to_owned(),
        _ => format!("  {line}\n"),
    });
    "\n".to_owned() + &indented.collect::<String>()
}

/// Column of the table: its heading, and the function that returns its value.
type Figure = (&'static str, fn(&Times) -> Option<f64>);

fn by_phase(program: &Program, cost: &Cost) -> TextTable {
    let phases = program.plan.phases.iter().zip(&cost.phases);
    let phases: Vec<_> = phases.filter(|(phase, _)| !phase.pre_attached).collect();
    let figures = |header, of: &dyn Fn(&PhaseCost) -> u32| {
        let cells = phases.iter().map(|(_, cost)| of(cost).to_string());
        TextColumn::figures(header, cells.collect())
    };
    let mut labels: Vec<String> = phases.iter().map(|(phase, _)| phase.name.clone()).collect();
    let mut columns = vec![
        figures("serial", &|cost| cost.depth),
        figures("parallel", &|cost| cost.width),
    ];
    if let Some(total) = cost.total {
        let is_many = phases.len() > 1;
        if is_many {
            labels.push("all".to_owned());
            columns
                .iter_mut()
                .for_each(|column| column.cells.push(String::new()));
        }
        let of: [Figure; 4] = [
            ("mean", |times| times.mean),
            ("10 %", |times| times.p10),
            ("median", |times| times.median),
            ("90 %", |times| times.p90),
        ];
        columns.extend(of.map(|(header, of)| {
            let times = phases.iter().map(|(_, cost)| cost.times);
            let times = times.chain(is_many.then_some(Some(total)));
            let ticks = times.map(|times| times.as_ref().and_then(of));
            let cell = |ticks: Option<f64>| ticks.map_or("-".into(), |it| number(it.round()));
            TextColumn::figures(header, ticks.map(cell).collect())
        }));
    }
    TextTable {
        label: match (cost.total, cost.lower_bound.is_empty()) {
            (None, _) => "phase",
            (Some(_), true) => "phase (times in ticks)",
            (Some(_), false) => "phase (lower bounds in ticks)",
        }
        .to_owned(),
        labels,
        columns,
        ..TextTable::default()
    }
}

fn by_capture(program: &Program, symbols: &Symbols, cost: &Cost, most: usize) -> TextTable {
    let shown = &cost.captures[..cost.captures.len().min(most)];
    let plan = &program.plan;
    let action = |capture: &CaptureCost| plan.event(capture.event).action();
    let labelled = shown.iter().map(|it| {
        let words = plan.describe(it.event, symbols);
        (action(it), words, plan.phase_name(it.event))
    });
    let shares = shown.iter().map(|it| percent(it.share)).collect();
    let waits = shown.iter().map(|it| number(it.wait.round())).collect();
    TextTable {
        label: "capture".to_owned(),
        labels: event_labels(cost.captures.iter().map(action), labelled),
        columns: vec![
            TextColumn::figures("share", shares),
            TextColumn::figures("waiting time", waits),
        ],
        ..TextTable::default()
    }
}

const SERIAL_AND_PARALLEL: &str = "serial: the longest chain of captures; parallel: the largest number of simultaneous captures, if \
    all take equally long.";

const SHARES: &str = "share: the part of the completion time spent waiting for this capture only; waiting time: mean \
    number of ticks from when its face is switched on.";

/// Returns the reason why times are missing, and a suggestion.
fn no_times(program: &Program, cost: &Cost) -> String {
    let unsupported = program.scene.as_ref().and_then(RateWorld::unsupported);
    match (unsupported, cost.has_rates) {
        (Some(unsupported), _) => format!("No times: {unsupported}."),
        (None, false) => "No times: this scene has no calibrated rates. Measure them with `stochc calibrate FILE --out X.rates`, and pass \
             them with `--rates X.rates`."
            .to_owned(),
        (None, true) if cost.draws.is_empty() => {
            "No times: one capture has no free block left.".to_owned()
        }
        (None, true) => "No times: a phase reaches its timeout in at least 90 % of the samples.".to_owned(),
    }
}
