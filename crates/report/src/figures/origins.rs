//! Figure of the former roles of captured blocks.
use std::collections::BTreeMap;

use stochc_ir::table::RoleId;
use stochc_results::EnsembleProgram;

use super::EDGE;
use crate::analysis::waits::ReportedCapture;
use crate::svg::letters::{fitted, widest};
use crate::svg::{Drawing, LegendEntry, LegendSymbol, Medium, PlotAxis, Scale, class};

/// Draws the origins of released blocks that are captured again, with one bar per capture. Returns
/// `None` if no run captures a released block again.
pub(crate) fn origins(
    medium: Medium,
    number: usize,
    label: &str,
    program: &EnsembleProgram,
    waits: &[ReportedCapture],
) -> Option<Drawing> {
    const TOP: f64 = 16.0;
    const ROW: f64 = 24.0;
    /// Number of former roles that have their own colour.
    const ROLES: usize = 6;
    let mut rows: Vec<&ReportedCapture> = waits
        .iter()
        .filter(|wait| !wait.released().is_empty())
        .collect();
    let all = rows.len();
    // The number of bars in the figure is limited. The data file contains all.
    rows.truncate(super::SHOWN);
    if rows.is_empty() {
        return None;
    }
    let mut totals: BTreeMap<RoleId, usize> = BTreeMap::new();
    for (role, n) in rows.iter().flat_map(|wait| wait.released()) {
        *totals.entry(*role).or_default() += n;
    }
    let mut roles: Vec<(RoleId, usize)> = totals.into_iter().collect();
    roles.sort_by_key(|&(role, n)| (std::cmp::Reverse(n), role));
    let position = |role: RoleId| roles.iter().position(|other| other.0 == role);
    let bottom = TOP + ROW * rows.len() as f64;
    let mut out = Drawing::new(
        medium,
        &format!("origins-{number}"),
        &format!("{label}: where captured blocks came from"),
        &description(program, &rows),
    );
    let names = widest(rows.iter().map(|wait| wait.text.as_str())).min(0.34 * medium.width());
    let (left, right) = (EDGE + names + 12.0, medium.width() - 24.0);
    let x = Scale::linear((0.0, 100.0), (left, right));
    let of = PlotAxis::new("part of the runs", "%");
    let foot = out.across(&x, (left, right), bottom, TOP, &of);
    for (row, wait) in rows.iter().enumerate() {
        let y = TOP + ROW * row as f64;
        out.text("ink", (EDGE, y + 16.0), &fitted(&wait.text, names));
        let total = wait.free() + wait.released().iter().map(|(_, n)| n).sum::<usize>();
        let mut from = 0.0;
        let mut bar = |colour: &str, hatch: usize, n: usize, what: &str| {
            let to = from + 100.0 * n as f64 / total as f64;
            let tooltip = format!("{}: {what}, {n} of {total}", wait.text);
            let size = (x.at(to) - x.at(from), 15.0);
            out.rectangle(
                &format!("bar {colour}"),
                (x.at(from), y + 4.0),
                size,
                &tooltip,
            );
            out.hatch(hatch, (x.at(from), y + 4.0), size);
            from = to;
        };
        let mut released = wait.released().to_vec();
        released.sort_by_key(|&(role, _)| position(role));
        for (role, n) in released {
            let tooltip = format!("released as {}", program.role(role));
            match position(role).filter(|&i| i < ROLES) {
                Some(i) => bar(class(i), i, n, &tooltip),
                None => bar("rest", 0, n, &tooltip),
            }
        }
        bar("grey", 0, wait.free(), "never captured before");
    }
    let key = |class: &str, hatch: usize, meaning: String| LegendEntry {
        class: format!("bar {class}"),
        sample: LegendSymbol::Bar(hatch),
        meaning,
    };
    let named = roles.iter().take(ROLES).enumerate();
    let mut keys: Vec<LegendEntry> = named
        .map(|(i, (role, _))| key(class(i), i, format!("released as {}", program.role(*role))))
        .collect();
    if roles.len() > ROLES {
        keys.push(key("rest", 0, "released as another".into()));
    }
    keys.push(key("grey", 0, "never captured before".into()));
    let foot = out.keys((EDGE, foot), medium.width() - EDGE, &keys);
    if all > rows.len() {
        out.text(
            "dim",
            (EDGE, 11.0),
            &format!("the first {} of {all}", rows.len()),
        );
    }
    Some(out.high(foot - 8.0))
}

fn description(program: &EnsembleProgram, rows: &[&ReportedCapture]) -> String {
    let row = |wait: &&ReportedCapture| {
        let total = wait.free() + wait.released().iter().map(|(_, n)| n).sum::<usize>();
        let each = wait.released().iter();
        let each = each.map(|(role, n)| format!("{n} released as {}", program.role(*role)));
        let each: Vec<_> = each.collect();
        format!("{}: {} of {total}", wait.text, each.join(", "))
    };
    let rows: Vec<_> = rows.iter().take(12).map(row).collect();
    format!("Each capture has a bar. {}.", rows.join(". "))
}
