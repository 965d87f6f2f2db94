//! Checks that targets that cannot be built are rejected with advice.
use stochc_ir::Cell;
use stochc_ir::table::Plate;
use stochc_planner::{Goal, Unplanned};
use stochc_planner::{TargetError, layers};

use crate::{named, tried};

fn error(goal: &Goal) -> (TargetError, String) {
    match tried(goal, 1) {
        Err(Unplanned::Refused(error)) => {
            let text = format!("{error}; {}", error.help().unwrap_or_default());
            (error, text)
        }
        other => panic!("{other:?}"),
    }
}

fn drawn(text: &str) -> Goal {
    Goal::from_cells("drawn", layers(text).unwrap())
}

#[test]
fn parts_in_the_air_are_refused_with_a_bridge() {
    let (_, text) = error(&drawn("# . . #\n\n# . . .\n\n# . # .\n"));
    assert_eq!(
        text,
        "1 cell of the target, (2, 0, 3), is attached to no block of the plate that may capture; \
         with 1 more cell, (1, 0, 3), it would be held"
    );
}

/// The bridges of all parts together support all of them, so one round suffices.
#[test]
fn all_loose_parts_are_reported_at_once() {
    let corners = "#".repeat(31) + "\n" + &".".repeat(31);
    let corners = format!(
        "{}\n\n{}\n{}\n",
        corners,
        ".".repeat(31),
        ".#.".repeat(10) + "."
    );
    let mut goal = drawn(&corners);
    let (error, text) = error(&goal);
    assert!(
        text.starts_with("10 parts of the target, 10 cells in all, are attached to no block"),
        "{text}"
    );
    assert!(text.contains("with 10 more cells, "), "{text}");
    let TargetError::Loose(parts) = error else {
        panic!("{text}");
    };
    let bridges = parts.into_iter().filter_map(|part| part.bridge);
    assert_eq!(goal.add_supports(), bridges.flatten().collect::<Vec<_>>());
    assert!(tried(&goal, 1).is_ok());
}

/// Returns a target on a plate of this width. Only one of its blocks may capture.
fn on_plate(text: &str, width: u32, seed: (i32, i32)) -> Goal {
    let mut goal = drawn(text);
    goal.plate = Some(Plate { width, depth: 1 });
    goal.seeds = Some(vec![seed]);
    goal
}

/// Parts of the target are always built, and the plate supports the blocks on it.
#[test]
fn a_bridge_leads_through_other_parts() {
    let (_, text) = error(&on_plate("# . # . #", 5, (4, 0)));
    let help = "with 2 more cells, (1, 0, 1) and (3, 0, 1), all parts would be held; or let a block of the plate under it capture";
    assert!(text.ends_with(help), "{text}");
    // Three cells through the other part, or five past it.
    let (_, text) = error(&on_plate("# . . # .\n# # . # #\n# . . . .", 6, (5, 0)));
    assert!(text.contains("with 3 more cells, "), "{text}");
}

/// The room itself can be built, but no block holds the block that floats in it.
#[test]
fn a_block_that_floats_in_a_sealed_room_is_refused() {
    let all = |edge: i32| 0..edge;
    let room = all(5).flat_map(|x| all(5).flat_map(move |y| all(5).map(move |z| (x, y, z))));
    let is_wall = |&(x, y, z): &(i32, i32, i32)| [x, y, z].iter().any(|&at| at == 0 || at == 4);
    let room = room.filter(is_wall).map(|(x, y, z)| Cell::new(x, y, z + 1));
    let mut cells: Vec<Cell> = room.collect();
    assert!(tried(&Goal::from_cells("room", cells.clone()), 1).is_ok());
    cells.push(Cell::new(2, 2, 3));
    let (error, text) = error(&Goal::from_cells("room", cells));
    let TargetError::Loose(parts) = error else {
        panic!("{text}");
    };
    assert_eq!(parts[0].cells, [Cell::new(2, 2, 3)]);
    assert_eq!(parts[0].bridge.as_ref().map(Vec::len), Some(1));
}

#[test]
fn seeds_count() {
    let mut goal = named("five_towers");
    goal.plate = Some(Plate { width: 3, depth: 3 });
    goal.seeds = Some(vec![(1, 1), (0, 0)]);
    let (error, _) = error(&goal);
    assert!(matches!(error, TargetError::Loose(parts) if parts.len() == 3));
}

#[test]
fn other_reasons() {
    let (_, text) = error(&drawn(""));
    assert_eq!(
        text,
        "the target has no cells; it needs a block at least: a `#` in a drawing, a voxel in a model"
    );
    let mut goal = drawn("#\n");
    goal.cells.push(Cell::new(0, 0, 0));
    let (_, text) = error(&goal);
    assert!(
        text.starts_with("1 cell of the target: (0, 0, 0), at or below the plate"),
        "{text}"
    );
    goal.cells = vec![Cell::new(0, 0, 1), Cell::new(i32::MAX, 0, 1)];
    let (_, text) = error(&goal);
    assert!(text.contains("too far away"), "{text}");
    let (_, text) = error(&named("blob_1000"));
    assert!(
        text.contains("1000 cells, and the scene 300 free blocks"),
        "{text}"
    );
    assert!(text.contains("at least 1000 free blocks"), "{text}");
}

#[test]
fn a_shape_without_room_is_a_diagnostic() {
    let mut goal = drawn("#\n");
    goal.cells = (1..60).map(|z| Cell::new(0, 0, z)).collect();
    let Err(Unplanned::Wrong(checked)) = tried(&Goal::from_cells("tower", goal.cells), 1) else {
        panic!("it lies outside of the enclosure");
    };
    assert_eq!(checked.diagnostics[0].code.name(), "outside-enclosure");
}
