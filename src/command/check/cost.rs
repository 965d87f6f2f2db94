//! What `check --cost` says of a program.
use stochc_compiler::cost::{Cost, estimate};
use stochc_compiler::{Program, Symbols};

/// A table of the phases, and one of the captures whose cells are most enclosed; empty if nothing was asked for.
pub fn costs(program: &Program, symbols: &Symbols, most: Option<usize>) -> String {
    let Some(most) = most.filter(|_| !program.plan.events.is_empty()) else {
        return String::new();
    };
    estimate(program).map_or(String::new(), |cost| table(program, symbols, &cost, most))
}

fn table(program: &Program, symbols: &Symbols, cost: &Cost, most: usize) -> String {
    let plan = &program.plan;
    let phase_width = (plan.phases.iter().map(|phase| phase.name.len()))
        .max()
        .unwrap_or(0)
        .max(5);
    let mut out = format!("\n  {:phase_width$}  depth  width\n", "phase");
    let phases = plan.phases.iter().zip(&cost.phases);
    for (phase, cost) in phases.filter(|(phase, _)| !phase.planted) {
        out.push_str(&format!(
            "  {:phase_width$}  {:5}  {:5}\n",
            phase.name, cost.depth, cost.width,
        ));
    }
    let shown = &cost.captures[..cost.captures.len().min(most)];
    let names: Vec<String> = (shown.iter())
        .map(|capture| plan.describe(capture.event, symbols))
        .collect();
    let width = names.iter().map(String::len).max().unwrap_or(0).max(7);
    out.push_str(&format!("\n  {:width$}  open\n", "capture"));
    for (name, capture) in names.iter().zip(shown) {
        out.push_str(&format!(
            "  {name:width$}  {:>4}\n",
            format!("{:.0} %", capture.exposure * 100.0),
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
        "\n  depth: captures one after the other; width: captures side by side, at most; open: directions from\n  \
         the cell that meet no block and no ground, the most enclosed cell first. This is geometry and no time:\n  \
         open cells are not captured sooner in general. `stochc simulate` measures waits.\n",
    );
    out
}
