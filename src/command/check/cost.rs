//! What `check` says of the cost of a program.
use stochc_compiler::cost::{Cost, estimate};
use stochc_compiler::{Program, Symbols};

/// Captures up to which the likely bottleneck is named unasked.
const UNASKED: usize = 1_000;

/// One line, or a table of the captures that take most of the time.
pub fn costs(program: &Program, symbols: &Symbols, most: Option<usize>) -> String {
    if program.plan.events.is_empty() || (most.is_none() && program.plan.events.len() > UNASKED) {
        return String::new();
    }
    let Some(cost) = estimate(program) else {
        return String::new();
    };
    match most {
        Some(most) => table(program, symbols, &cost, most),
        None => bottleneck(program, symbols, &cost),
    }
}

fn bottleneck(program: &Program, symbols: &Symbols, cost: &Cost) -> String {
    let Some(first) = cost.captures.first() else {
        return String::new();
    };
    format!(
        "  likely bottleneck: {}, {} of the time; `--cost` ranks the others\n",
        program.plan.describe(first.event, symbols),
        percent(first.share),
    )
}

fn table(program: &Program, symbols: &Symbols, cost: &Cost, most: usize) -> String {
    let plan = &program.plan;
    let phase_width = (plan.phases.iter().map(|phase| phase.name.len()))
        .max()
        .unwrap_or(0)
        .max(5);
    let mut out = format!("\n  {:phase_width$}  depth  width  time\n", "phase");
    let phases = plan.phases.iter().zip(&cost.phases);
    for (phase, cost) in phases.filter(|(phase, _)| !phase.planted) {
        out.push_str(&format!(
            "  {:phase_width$}  {:5}  {:5}  {:>4}\n",
            phase.name,
            cost.depth,
            cost.width,
            percent(cost.share),
        ));
    }
    let shown = &cost.captures[..cost.captures.len().min(most)];
    let names: Vec<String> = (shown.iter())
        .map(|capture| plan.describe(capture.event, symbols))
        .collect();
    let width = names.iter().map(String::len).max().unwrap_or(0).max(7);
    out.push_str(&format!("\n  {:width$}  open  wait  time\n", "capture"));
    for (name, capture) in names.iter().zip(shown) {
        out.push_str(&format!(
            "  {name:width$}  {:>4}  {:4.1}  {:>4}\n",
            percent(capture.exposure),
            capture.wait,
            percent(capture.share),
        ));
    }
    let rest = cost.captures.len() - shown.len();
    if rest > 0 {
        out.push_str(&format!(
            "  and {rest} more; `--cost {}` shows them\n",
            cost.captures.len()
        ));
    }
    out.push_str(
        "\n  open: directions from the cell that meet no block and no ground; wait: its inverse; time: the\n  \
         expected share of the time to completion. From the geometry alone, for ranking.\n",
    );
    out
}

fn percent(part: f64) -> String {
    format!("{:.0} %", part * 100.0)
}
