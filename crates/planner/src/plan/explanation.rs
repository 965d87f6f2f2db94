//! Explanation of a plan in words and as a picture.
use std::fmt::Write as _;

use stochc_ir::{Cell, CellBounds};
use stochc_text::counted;

use crate::plan::baseline::Baseline;
use crate::plan::build_plan::{Alternative, BuildPlan, RaceTimes};
use crate::plan::capture::Capture;
use crate::target::error::listed_cells;
use crate::timing::precedence::Why;

/// Largest number of critical captures in the explanation.
const MAX_LISTED: usize = 6;

/// Largest number of cells of a picture along x.
const WIDEST: i32 = 24;

/// Largest number of layers of a picture.
const MAX_LAYERS: i32 = 12;

/// Explains a plan: its order, its limits, and the costs of alternatives.
pub fn explanation(plan: &BuildPlan) -> String {
    let mut out = String::new();
    let captures: Vec<Capture> = plan.all_captures().cloned().collect();
    let captures = &captures;
    let handed_over = (plan.dismantling.as_ref()).map_or(0, |it| it.hand_overs.len());
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "{}, at most {} open at the same time\n\
         estimate: {}",
        counted(captures.len() + handed_over, "capture"),
        counted(plan.widest, "face"),
        plan.estimate.in_words(" on average,"),
    );
    let waits = |why: Why| {
        let all = captures.iter().flat_map(|capture| &capture.after);
        all.filter(|(_, is)| *is == why).count()
    };
    let _ = writeln!(
        out,
        "waits: {} keep ways in open, {} keep faces at a corner from being open together",
        waits(Why::AccessPath),
        waits(Why::Near),
    );
    let narrow: Vec<Cell> = captures
        .iter()
        .filter(|it| it.is_tight)
        .map(|it| it.cell)
        .collect();
    let _ = match narrow.len() {
        0 if plan.baseline.is_some() => writeln!(out, "access paths: not checked"),
        0 => writeln!(
            out,
            "access paths: two cells wide for every cell, in every order"
        ),
        _ => writeln!(
            out,
            "access paths: two cells wide, except for {} one cell wide: {}",
            narrow.len(),
            listed_cells(&narrow)
        ),
    };
    if let Some(dismantling) = &plan.dismantling {
        let masts = dismantling.masts.iter().map(|mast| {
            let ((x, y), height) = (mast.foot, mast.height);
            format!("{height} on ({x}, {y})")
        });
        let _ = writeln!(
            out,
            "masts: {}; blocks that are handed over from them: {}",
            masts.collect::<Vec<_>>().join(", "),
            dismantling.hand_overs.len()
        );
    }
    let _ = writeln!(out, "{}", plan.scaffolds);
    if let Some(baseline) = plan.baseline {
        let _ = writeln!(out, "needs no thought: {}", baseline.words());
    }
    out += &picture(captures);
    let mut critical: Vec<&Capture> = captures.iter().collect();
    let weight = |capture: &Capture| f64::from(capture.decides) * capture.wait;
    critical.sort_by(|a, b| weight(b).total_cmp(&weight(a)));
    let is_known = !plan.estimate.is_typical;
    out += "what decides when a run ends: in how many runs";
    out += if is_known {
        ", and the mean wait\n"
    } else {
        "\n"
    };
    for capture in critical.iter().take(MAX_LISTED) {
        let cell = capture.cell.to_string();
        let _ = write!(out, "  {cell:<14} {:>4.0} %", 100.0 * capture.decides);
        let _ = if is_known {
            writeln!(out, "  {:>6.0} ticks", capture.wait)
        } else {
            writeln!(out)
        };
    }
    if !plan.alternatives.is_empty() {
        out += "alternatives that need no thought, as they would be if no block jammed\n";
    }
    for Alternative {
        baseline,
        estimate,
        diagnostic,
    } in &plan.alternatives
    {
        let diagnostic = diagnostic.map_or(String::new(), |code| format!("; `check` finds {code}"));
        let time = if is_known {
            format!(
                "{}{:.0} ticks",
                estimate.lower_bound.prefix(),
                estimate.mean
            )
        } else {
            let ratio = estimate.mean / plan.estimate.mean;
            format!("about {ratio:.1} times as long as the plan")
        };
        let _ = writeln!(out, "  {}: {time}{diagnostic}", baseline.words());
    }
    let _ = writeln!(out, "{} schedules tried", plan.rounds);
    out
}

/// Writes the times of a race as a list. Returns an empty text without a race.
pub fn race_to_text(race: &[RaceTimes]) -> String {
    let mut out = String::new();
    if !race.is_empty() {
        out += "race with physics: mean ticks, ± is the 95 % confidence interval\n";
    }
    for times in race {
        let name = times.baseline.map_or("planned", Baseline::words);
        let stopped = match times.stopped {
            0 => String::new(),
            stopped => format!(", {stopped} stopped"),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "  {name}: {:.0} ± {:.0} ({}{stopped})",
            times.mean,
            times.error,
            counted(times.runs as usize, "run"),
        );
    }
    out
}

/// Draws the opening order of the cells, layer by layer. Returns an empty string if it is too
/// large.
fn picture(captures: &[Capture]) -> String {
    let Some(CellBounds { low, high }) = CellBounds::enclosing(captures.iter().map(|it| it.cell))
    else {
        return String::new();
    };
    let (width, depth, height) = (high.x - low.x, high.y - low.y, high.z - low.z);
    if width >= WIDEST || depth >= WIDEST || height >= MAX_LAYERS {
        return String::new();
    }
    let mut order: Vec<(Cell, usize)> = captures
        .iter()
        .enumerate()
        .map(|(i, capture)| (capture.cell, i + 1))
        .collect();
    order.sort_unstable();
    let width = captures.len().to_string().len();
    let mut out = "opening order of the faces, north at the top\n".to_owned();
    for z in low.z..=high.z {
        let _ = writeln!(out, "  layer {z}");
        for y in (low.y..=high.y).rev() {
            out.push_str("   ");
            for x in low.x..=high.x {
                let found = order.binary_search_by_key(&Cell::new(x, y, z), |&(cell, _)| cell);
                let sign = found.map_or(".".to_owned(), |at| order[at].1.to_string());
                let _ = write!(out, " {sign:>width$}");
            }
            out.push('\n');
        }
    }
    out
}
