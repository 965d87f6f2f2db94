//! Where captured blocks came from.
use std::collections::BTreeMap;

use stochc_ensemble::EnsembleProgram;
use stochc_ir::table::RoleId;

use super::{WIDTH, short};
use crate::analysis::waits::ReportedCapture;
use crate::svg::{Drawing, Scale, class};

/// A bar for each capture that ever took a block that had been released; `None`: none did.
pub(crate) fn origins(
    number: usize,
    label: &str,
    program: &EnsembleProgram,
    waits: &[ReportedCapture],
) -> Option<Drawing> {
    const LEFT: f64 = 190.0;
    const RIGHT: f64 = WIDTH - 24.0;
    const TOP: f64 = 16.0;
    const ROW: f64 = 24.0;
    /// Roles that have a colour of their own.
    const ROLES: usize = 6;
    let mut rows: Vec<&ReportedCapture> = waits
        .iter()
        .filter(|wait| !wait.released().is_empty())
        .collect();
    let all = rows.len();
    // A figure is no place for thousands of bars; the data file has them all.
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
    let place = |role: RoleId| roles.iter().position(|other| other.0 == role);
    let bottom = TOP + ROW * rows.len() as f64;
    let keys = roles.len().min(ROLES) + 1 + usize::from(roles.len() > ROLES);
    let legend = 19.0 * keys.div_ceil(3) as f64;
    let mut out = Drawing::new(
        &format!("origins-{number}"),
        &format!("{label}: where captured blocks came from"),
        &told(program, &rows),
        (WIDTH, bottom + 50.0 + legend),
    );
    let x = Scale::linear((0.0, 100.0), (LEFT, RIGHT));
    out.across(&x, (LEFT, RIGHT), bottom, TOP, "part of the runs [%]");
    for (row, wait) in rows.iter().enumerate() {
        let y = TOP + ROW * row as f64;
        out.text("ink", (8.0, y + 16.0), &short(&wait.text, 26));
        let total = wait.free() + wait.released().iter().map(|(_, n)| n).sum::<usize>();
        let mut from = 0.0;
        let mut bar = |colour: &str, hatch: usize, n: usize, what: &str| {
            let to = from + 100.0 * n as f64 / total as f64;
            let told = format!("{}: {what}, {n} of {total}", wait.text);
            let size = (x.at(to) - x.at(from), 15.0);
            out.rectangle(&format!("bar {colour}"), (x.at(from), y + 4.0), size, &told);
            out.hatch(hatch, (x.at(from), y + 4.0), size);
            from = to;
        };
        let mut released = wait.released().to_vec();
        released.sort_by_key(|&(role, _)| place(role));
        for (role, n) in released {
            let told = format!("released as {}", program.role(role));
            match place(role).filter(|&i| i < ROLES) {
                Some(i) => bar(class(i), i, n, &told),
                None => bar("rest", 0, n, &told),
            }
        }
        bar("grey", 0, wait.free(), "never captured before");
    }
    let named = roles.iter().take(ROLES).enumerate();
    let mut keys: Vec<(String, String)> = named
        .map(|(i, (role, _))| {
            (
                class(i).to_owned(),
                format!("released as {}", program.role(*role)),
            )
        })
        .collect();
    if roles.len() > ROLES {
        keys.push(("rest".into(), "released as another".into()));
    }
    keys.push(("grey".into(), "never captured before".into()));
    for (i, (colour, meaning)) in keys.iter().enumerate() {
        let (column, row) = (i % 3, i / 3);
        let at = (
            40.0 + 235.0 * column as f64,
            bottom + 58.0 + 19.0 * row as f64,
        );
        out.rectangle(
            &format!("bar {colour}"),
            (at.0, at.1 - 10.0),
            (12.0, 12.0),
            "",
        );
        let hatch = if i < roles.len().min(ROLES) { i } else { 0 };
        out.hatch(hatch, (at.0, at.1 - 10.0), (12.0, 12.0));
        out.text("ink", (at.0 + 18.0, at.1), &short(meaning, 28));
    }
    if all > rows.len() {
        out.text(
            "dim",
            (8.0, 11.0),
            &format!("the first {} of {all}", rows.len()),
        );
    }
    Some(out)
}

fn told(program: &EnsembleProgram, rows: &[&ReportedCapture]) -> String {
    let row = |wait: &&ReportedCapture| {
        let total = wait.free() + wait.released().iter().map(|(_, n)| n).sum::<usize>();
        let each = wait.released().iter();
        let each = each.map(|(role, n)| format!("{n} released as {}", program.role(*role)));
        let each: Vec<_> = each.collect();
        format!("{}: {} of {total}", wait.text, each.join(", "))
    };
    let rows: Vec<_> = rows.iter().take(12).map(row).collect();
    format!("A bar for each capture. {}.", rows.join(". "))
}
