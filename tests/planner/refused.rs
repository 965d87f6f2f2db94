//! What cannot be built is refused, with what would help.
use stochc::ir::Cell;
use stochc::ir::table::Plate;
use stochc::planner::{Refusal, layers};
use stochc::planning::{Goal, Unplanned};

use crate::{named, tried};

fn refusal(goal: &Goal) -> (Refusal, String) {
    match tried(goal, 1) {
        Err(Unplanned::Refused(refusal)) => {
            let told = format!("{refusal}; {}", refusal.help().unwrap_or_default());
            (refusal, told)
        }
        other => panic!("{other:?}"),
    }
}

fn drawn(text: &str) -> Goal {
    Goal::of_cells("drawn", layers(text).unwrap())
}

#[test]
fn parts_in_the_air_are_refused_with_a_bridge() {
    let (_, told) = refusal(&drawn("# . . #\n\n# . . .\n\n# . # .\n"));
    assert_eq!(
        told,
        "1 cell of the target: (2, 0, 3), hang together with no block of the plate that may capture; \
         with 1 cell more, (1, 0, 3), the first part would be held; or let a block of the plate under it \
         capture"
    );
}

/// The room itself is built; what floats in it is held by nothing.
#[test]
fn a_block_that_floats_in_a_sealed_room_is_refused() {
    let all = |edge: i32| 0..edge;
    let room = all(5).flat_map(|x| all(5).flat_map(move |y| all(5).map(move |z| (x, y, z))));
    let is_wall = |&(x, y, z): &(i32, i32, i32)| [x, y, z].iter().any(|&at| at == 0 || at == 4);
    let room = room.filter(is_wall).map(|(x, y, z)| Cell::new(x, y, z + 1));
    let mut cells: Vec<Cell> = room.collect();
    assert!(tried(&Goal::of_cells("room", cells.clone()), 1).is_ok());
    cells.push(Cell::new(2, 2, 3));
    let (refusal, told) = refusal(&Goal::of_cells("room", cells));
    let Refusal::Loose(parts) = refusal else {
        panic!("{told}");
    };
    assert_eq!(parts[0].cells, [Cell::new(2, 2, 3)]);
    assert_eq!(parts[0].bridge.as_ref().map(Vec::len), Some(1));
}

#[test]
fn seeds_count() {
    let mut goal = named("five_towers");
    goal.plate = Some(Plate { width: 3, depth: 3 });
    goal.seeds = Some(vec![(1, 1), (0, 0)]);
    let (refusal, _) = refusal(&goal);
    assert!(matches!(refusal, Refusal::Loose(parts) if parts.len() == 3));
}

#[test]
fn other_reasons() {
    let (_, told) = refusal(&drawn(""));
    assert_eq!(told, "the target has no cells; draw a `#` for each block");
    let mut goal = drawn("#\n");
    goal.cells.push(Cell::new(0, 0, 0));
    let (_, told) = refusal(&goal);
    assert!(
        told.starts_with("1 cell of the target: (0, 0, 0), at or below the plate"),
        "{told}"
    );
    goal.cells = vec![Cell::new(0, 0, 1), Cell::new(i32::MAX, 0, 1)];
    let (_, told) = refusal(&goal);
    assert!(told.contains("too far away"), "{told}");
    let (_, told) = refusal(&named("blob_1000"));
    assert!(
        told.contains("1000 cells, and the scene 300 free blocks"),
        "{told}"
    );
    assert!(told.contains("`free 1000 uniform`"), "{told}");
}

#[test]
fn what_the_scene_has_no_room_for_is_told_as_a_finding() {
    let mut goal = drawn("#\n");
    goal.cells = (1..60).map(|z| Cell::new(0, 0, z)).collect();
    let Err(Unplanned::Wrong(checked)) = tried(&Goal::of_cells("tower", goal.cells), 1) else {
        panic!("it lies outside of the enclosure");
    };
    assert_eq!(checked.diagnostics[0].code.name(), "outside-enclosure");
}
