//! Estimates of plans, as `check --cost` computes them for their programs.
use std::collections::HashMap;

use stochc_compiler::Checked;
use stochc_compiler::expanded::EventId;
use stochc_estimate::{Rates, Times};
use stochc_ir::Cell;

use crate::{BuildPlan, PlanEstimate, RateLaw};

/// Replaces the estimate and the waiting times of a plan by the values of `check --cost`. Keeps the
/// planner's values if the check has none.
pub(super) fn price(plan: &mut BuildPlan, checked: &Checked, law: &RateLaw<'_>) {
    let program = checked.programs.first();
    let cost = program.and_then(|program| program.estimate(law.rates()));
    let total = cost.as_ref().and_then(|cost| cost.total);
    let lower_bound = cost.as_ref().map(|cost| cost.lower_bound);
    plan.estimate = PlanEstimate {
        lower_bound: lower_bound.unwrap_or_default(),
        ..estimate(total, law, plan.estimate)
    };
    let (Some(program), Some(cost)) = (program, cost) else {
        return;
    };
    // A handed-over block is captured twice. This takes the first capture.
    let mut waits: HashMap<Cell, (EventId, f64)> = HashMap::new();
    for capture in &cost.captures {
        if let Some(cell) = program.layout.cells[capture.event.0 as usize] {
            let known = waits.entry(cell).or_insert((capture.event, capture.wait));
            if capture.event < known.0 {
                *known = (capture.event, capture.wait);
            }
        }
    }
    for capture in plan.all_captures_mut() {
        if let Some((_, wait)) = waits.get(&capture.cell) {
            capture.wait = *wait;
        }
    }
}

/// Returns the estimate from the times of the check. Uses the estimate `found` by the planner if
/// the times are unknown.
pub(super) fn estimate(
    times: Option<Times>,
    law: &RateLaw<'_>,
    found: PlanEstimate,
) -> PlanEstimate {
    let rates = law.rates();
    let known = times.and_then(|times| Some((times.mean?, times.p90?)));
    let (mean, p90) = known.unwrap_or((found.mean, found.p90));
    PlanEstimate {
        mean,
        p90,
        is_typical: rates.is_none(),
        is_first_guess: rates.is_some_and(Rates::is_guess),
        lower_bound: found.lower_bound,
    }
}
