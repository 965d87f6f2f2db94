//! Warns of phases whose timeout is shorter than they need.
use stochc_estimate::{Rates, estimate, estimate_without_timeouts, times_out_rarely};
use stochc_ir::table::Phase;

use crate::Program;
use crate::diagnostic::{Code, Diagnostic, report};

/// Largest number of events of a small program. Every check estimates the times of small programs.
pub const MAX_ESTIMATED: usize = 2_000;

/// Largest share of runs that a timeout may end without a warning.
const MAX_TIMED_OUT: f64 = 0.5;

/// Reports phases whose timeout would end more than half of the runs that reach them. Uses the
/// calibrated rates of the scene.
pub fn check(program: &Program, diagnostics: &mut Vec<Diagnostic>) {
    let phases = &program.plan.phases;
    for (phase, table) in phases.iter().zip(tables(program)) {
        if table.timeout.is_some_and(|timeout| timeout < table.wait) {
            let title = format!("phase `{}` always times out", phase.name);
            let label = format!("this phase waits for {} ticks", table.wait);
            let diagnostic = Diagnostic::new(Code::ShortTimeout, title)
                .label(phase.location, label)
                .help("write a timeout that is longer than the `wait`");
            return report(diagnostics, diagnostic);
        }
    }
    let has_timeout = phases.iter().any(|phase| phase.timeout.is_some());
    if !has_timeout || program.plan.events.len() > MAX_ESTIMATED {
        return;
    }
    let graph = program.event_graph();
    let (Some(parts), Some(rates)) = (
        program.parts(&graph),
        program.scene.as_ref().and_then(Rates::built_in),
    ) else {
        return;
    };
    // Most programs need no full estimate, which takes most of the time of a small check.
    if times_out_rarely(parts, rates) {
        return;
    }
    let Some(cost) = estimate(parts, Some(rates)) else {
        return;
    };
    let is_short = |timed_out: f64| timed_out > MAX_TIMED_OUT;
    if !cost.phases.iter().any(|phase| is_short(phase.timed_out)) {
        return;
    }
    let unlimited = estimate_without_timeouts(parts, rates);
    for (number, (phase, cost)) in phases.iter().zip(&cost.phases).enumerate() {
        if !is_short(cost.timed_out) {
            continue;
        }
        let title = format!(
            "phase `{}` would time out in {:.0} % of the runs that reach it",
            phase.name,
            (100.0 * cost.timed_out).floor()
        );
        let label = "the rate model predicts that most runs end here";
        let needed = unlimited
            .as_ref()
            .and_then(|cost| cost.phases[number].times?.p90);
        let help = match needed {
            Some(ticks) => format!(
                "write `timeout {:.0} ticks`: nine of ten runs complete the phase in this time",
                round_up(ticks)
            ),
            None => "write a longer timeout".to_owned(),
        };
        let diagnostic = Diagnostic::new(Code::ShortTimeout, title).label(phase.location, label);
        report(diagnostics, diagnostic.help(help));
    }
}

/// Returns the tables of the phases. Returns none if the program has errors.
fn tables(program: &Program) -> &[Phase] {
    let tables = program.tables.as_ref();
    tables.map_or(&[], |tables| &tables.phases)
}

/// Rounds a number of ticks up to two digits.
fn round_up(ticks: f64) -> f64 {
    let digit = 10_f64.powf(ticks.max(10.0).log10().floor() - 1.0);
    (ticks / digit).ceil() * digit
}
