//! Tests programs of shapes with repeated parts.
use stochc_ir::Cell;
use stochc_ir::table::Plate;

use super::*;
use crate::plan::build_plan::plan;
use crate::{PlanSearch, RateLaw};

fn written(cells: Vec<Cell>) -> String {
    let plate = Plate {
        width: 20,
        depth: 20,
    };
    let hardware = crate::Hardware {
        faces: 1,
        attracts_always: false,
        free: 1000,
    };
    let declarations = declaration("wanted", &cells).unwrap();
    let target = Target::new(cells, plate, None, hardware.free).unwrap();
    let plans = plan(
        &target,
        hardware,
        &RateLaw::new(None),
        PlanSearch::default(),
    )
    .unwrap();
    let naming = Naming {
        assembly: "build",
        scene: None,
        shape: Some("wanted"),
        declarations: &declarations,
        allowed: &[],
    };
    program(&target, &plans.plain, naming).unwrap()
}

/// Returns the body of the first phase with single spaces.
fn phase(text: &str) -> String {
    let (_, phase) = text.split_once("phase grow {").unwrap();
    phase.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn towers_far_apart_are_a_loop_in_a_loop() {
    let places = (0..4).flat_map(|x| (0..3).map(move |y| (3 * x + 1, y + y)));
    let cells = places.flat_map(|(x, y)| (1..4).map(move |z| Cell::new(x, y, z)));
    let text = written(cells.collect());
    assert_eq!(
        phase(&text),
        "/// Begins at once. for x in 0..3 { for y in 0..2 { P[3 * x + 1, 2 * y].up ->> B[3 * x + 1, 2 * y, 1..3] } } \
         yields wanted } }"
    );
    assert!(
        text.contains("P[3 * x + 1, 2 * y] at (3 * x + 1, 2 * y)"),
        "{text}"
    );
}

#[test]
fn captures_of_one_block_are_in_order() {
    // A mast has four arms on each of five levels.
    let mut cells: Vec<Cell> = (1..=11).map(|z| Cell::new(5, 5, z)).collect();
    for z in [3, 5, 7, 9, 11] {
        cells.extend([(6, 5), (7, 5), (4, 5), (5, 6), (5, 4)].map(|(x, y)| Cell::new(x, y, z)));
    }
    let text = written(cells);
    let checked = stochc_grammar::format(&text).unwrap();
    assert_eq!(checked, text);
}
