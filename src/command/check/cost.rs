//! What `check --cost` says of a program.
use stochc_compiler::cost::{Cost, PhaseCost, estimate};
use stochc_compiler::{Program, Symbols};
use stochc_ensemble::text::percent;
use stochc_report::text::{Column, Table};

/// A table of the phases, and one of the captures whose cells are most enclosed; empty if nothing was asked for.
pub fn costs(program: &Program, symbols: &Symbols, most: Option<usize>) -> String {
    let Some(most) = most.filter(|_| !program.plan.events.is_empty()) else {
        return String::new();
    };
    estimate(program).map_or(String::new(), |cost| table(program, symbols, &cost, most))
}

fn table(program: &Program, symbols: &Symbols, cost: &Cost, most: usize) -> String {
    let plan = &program.plan;
    let phases = plan.phases.iter().zip(&cost.phases);
    let phases: Vec<_> = phases.filter(|(phase, _)| !phase.planted).collect();
    let figures = |header, of: &dyn Fn(&PhaseCost) -> u32| {
        let cells = phases.iter().map(|(_, cost)| of(cost).to_string());
        Column::figures(header, cells.collect())
    };
    let by_phase = Table {
        label: "phase".to_owned(),
        labels: phases.iter().map(|(phase, _)| phase.name.clone()).collect(),
        columns: vec![
            figures("depth", &|cost| cost.depth),
            figures("width", &|cost| cost.width),
        ],
        ..Table::default()
    };
    let shown = &cost.captures[..cost.captures.len().min(most)];
    let by_capture = Table {
        label: "capture".to_owned(),
        labels: (shown.iter())
            .map(|capture| plan.describe(capture.event, symbols))
            .collect(),
        columns: vec![Column::figures(
            "open",
            shown.iter().map(|it| percent(it.exposure)).collect(),
        )],
        ..Table::default()
    };
    let rest = match cost.captures.len() {
        all if all > shown.len() => format!(
            "and {} more; `--cost {all}` shows them\n",
            all - shown.len()
        ),
        _ => String::new(),
    };
    let text = format!(
        "{}\n{}{rest}\n{MEANING}",
        by_phase.text(usize::MAX, false),
        by_capture.text(usize::MAX, false),
    );
    let indented = text.lines().map(|line| match line {
        "" => "\n".to_owned(),
        _ => format!("  {line}\n"),
    });
    "\n".to_owned() + &indented.collect::<String>()
}

const MEANING: &str = "\
depth: captures one after the other; width: captures side by side, at most; open: directions from
the cell that meet no block and no ground, the most enclosed cell first. This is geometry and no time:
open cells are not captured sooner in general. `stochc simulate` measures waits.
";
