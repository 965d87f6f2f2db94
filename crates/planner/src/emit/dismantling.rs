//! Program text of the phase that hands over blocks and removes masts.
use std::fmt::Write as _;

use stochc_ir::{Cell, Face};

use super::loop_nest::{COUNTERS, MIN};
use super::statement::{Called, NameWords};
use crate::plan::capture::Capture;
use crate::scaffold::{Dismantling, HandOver, Mast};

/// Returns the captures of the second phase. Handed-over blocks come first, so that no other
/// capture takes their faces.
pub fn captures(dismantling: &Dismantling) -> Vec<Capture> {
    let handed_over = dismantling
        .hand_overs
        .iter()
        .map(|it| Capture::at_once(it.cell, it.direction));
    handed_over
        .chain(dismantling.captures.iter().cloned())
        .collect()
}

/// Writes the releases and their conditions.
pub fn write_releases(dismantling: &Dismantling, out: &mut String) {
    if !dismantling.hand_overs.is_empty() {
        out.push_str("/// Blocks on masts are handed over: a block released next to an open face stays in place.\n");
    }
    let mut rest = &dismantling.hand_overs[..];
    while !rest.is_empty() {
        let (row, others) = rest.split_at(row(rest));
        match along(row) {
            Some(axis) => write_row(row, axis, out),
            None => row.iter().for_each(|it| {
                let after = it.after.map(|cell| block(Called::Block, cell));
                write_release(&block(Called::Block, it.cell), after, out);
            }),
        }
        rest = others;
    }
    if dismantling.are_permanent {
        return;
    }
    for (
        i,
        Mast {
            foot: (x, y),
            height,
            after,
        },
    ) in dismantling.masts.iter().enumerate()
    {
        if i == 0 {
            out.push_str("/// Masts are released when they hold nothing.\n");
        }
        let levels = if *height == 1 {
            "1".to_owned()
        } else {
            format!("1..{height}")
        };
        let after = after.iter().map(|&cell| block(Called::Block, cell));
        let name = NameWords::OWN.name(Called::Scaffold);
        write_release(&format!("{name}[{x}, {y}, {levels}]"), after, out);
    }
}

/// Returns the number of hand-overs in the row at the start of `rest`. A row consists of
/// consecutive hand-overs in one direction. Returns 1 if the row is too short for a loop.
fn row(rest: &[HandOver]) -> usize {
    let continues = |two: &&[HandOver]| {
        two[1].direction == rest[0].direction && two[1].after == Some(two[0].cell)
    };
    // The first one must wait for the cell before it.
    let begins = rest[0].after == rest[0].cell.across(rest[0].direction.opposite());
    match 1 + rest.windows(2).take_while(continues).count() {
        length if begins && length >= MIN => length,
        _ => 1,
    }
}

/// Returns the axis of a row (0 is x, 1 is y, 2 is z). Returns `None` for a single hand-over.
fn along(row: &[HandOver]) -> Option<usize> {
    (row.len() > 1).then(|| match row[0].direction {
        Face::East | Face::West => 0,
        Face::North | Face::South => 1,
        Face::Up | Face::Down => 2,
    })
}

fn write_row(row: &[HandOver], axis: usize, out: &mut String) {
    let cells = || row.iter().map(|it| <[i32; 3]>::from(it.cell));
    let (first, last) = (
        cells().map(|at| at[axis]).min().unwrap_or(0),
        cells().map(|at| at[axis]).max().unwrap_or(0),
    );
    let step = row[0].direction.normal()[axis];
    let counter = COUNTERS[axis];
    let indices = |here: String| {
        let mut at = <[i32; 3]>::from(row[0].cell).map(|at| at.to_string());
        at[axis] = here;
        format!("{}[{}]", NameWords::OWN.name(Called::Block), at.join(", "))
    };
    let before = if step > 0 { "- 1" } else { "+ 1" };
    // Writing to a string cannot fail.
    let _ = writeln!(out, "for {counter} in {first}..{last} {{");
    write_release(
        &indices(counter.to_owned()),
        [indices(format!("{counter} {before}"))],
        out,
    );
    out.push_str("}\n");
}

fn block(called: Called, Cell { x, y, z }: Cell) -> String {
    format!("{}[{x}, {y}, {z}]", NameWords::OWN.name(called))
}

fn write_release(what: &str, after: impl IntoIterator<Item = String>, out: &mut String) {
    let after: Vec<String> = after.into_iter().collect();
    // Writing to a string cannot fail.
    let _ = if after.is_empty() {
        writeln!(out, "release {what}")
    } else {
        writeln!(out, "release {what} after {}", after.join(", "))
    };
}
