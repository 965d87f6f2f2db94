//! Checks plans of planar worlds.
use proptest::prelude::*;
use stochc_compiler::check_text;
use stochc_ir::record::Outcome;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_planner::{Goal, Planned, TargetError, Unplanned};
use stochc_runtime::{Model, Settings};

use crate::{cells, compile, simulate, tried};

/// Generates connected cells next to a seed in the south-west corner of a square.
fn grown() -> impl Strategy<Value = Vec<Cell>> {
    proptest::collection::vec((any::<u16>(), 0..4usize), 1..70).prop_map(|steps| {
        let mut cells = vec![Cell::new(0, 0, 1)];
        for (from, face) in steps {
            let from = cells[usize::from(from) % cells.len()];
            let next = from.across(Face::SIDES[face]).unwrap();
            let is_inside = (0..6).contains(&next.x) && (0..6).contains(&next.y);
            if is_inside && !cells.contains(&next) {
                cells.push(next);
            }
        }
        cells.remove(0);
        cells
    })
}

/// Returns the goal to build a shape on a table of this size \[cells\].
fn goal(shape: &[Cell], [length, width]: [i32; 2]) -> Goal {
    let mut goal = Goal::from_cells("grown", shape.to_vec());
    let scene = format!(
        "scene table from hemisphere {{
            world planar  free 60 uniform
            enclosure rectangle {{ length {}cm  width {}cm  wall 25 N/m }}
        }}\n",
        20 * length,
        20 * width
    );
    goal.declare_scene("table", &scene);
    goal.plate = Some(Plate { width: 6, depth: 6 });
    goal.seeds = Some(vec![(0, 0)]);
    goal
}

/// Executes the program of a plan in random orders. Returns the captured cells, sorted.
fn built(planned: &Planned) -> Vec<Cell> {
    let executable = compile(check_text("planned.sa", &planned.text)).remove(0);
    let record = simulate(&executable, &Settings::new(Model::Shuffle, 1), 5, 0);
    assert_eq!(record.outcome, Outcome::Completed, "{}", planned.text);
    let mut built: Vec<Cell> = record.all_bonds().map(|bond| bond.cell).collect();
    built.sort_unstable();
    built
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn connected_shapes_are_built_in_the_plane(shape in grown(), rounds in 1u64..8) {
        prop_assume!(!shape.is_empty());
        let planned = tried(&goal(&shape, [20, 20]), rounds).unwrap();
        let mut expected = shape;
        expected.sort_unstable();
        prop_assert_eq!(&cells(&planned.plan), &expected);
        prop_assert_eq!(built(&planned), expected);
    }

    /// Checks shapes at walls on up to three sides. Some of them cannot be built.
    #[test]
    fn walls_are_obstacles(shape in grown(), sizes in prop::sample::select(vec![[6, 10], [7, 9], [12, 6]])) {
        prop_assume!(!shape.is_empty());
        match tried(&goal(&shape, sizes), 2) {
            Ok(planned) => {
                let mut expected = shape;
                expected.sort_unstable();
                prop_assert_eq!(built(&planned), expected);
            }
            Err(Unplanned::Refused(TargetError::Sealed(_))) => {}
            Err(other) => prop_assert!(false, "{other:?}"),
        }
    }
}

#[test]
fn cells_outside_the_plane_and_plates_without_seeds_are_refused() {
    let cell = |x, z| Cell::new(x, 0, z);
    let refused = |goal: &Goal| match tried(goal, 1) {
        Err(Unplanned::Refused(error)) => error,
        other => panic!("{other:?}"),
    };
    for taken in [cell(0, 1), cell(1, 2)] {
        let goal = goal(&[cell(1, 1), taken], [20, 20]);
        assert_eq!(refused(&goal), TargetError::NotInPlane(vec![taken]));
    }
    let mut goal = goal(&[cell(1, 1)], [20, 20]);
    assert!(tried(&goal, 1).is_ok());
    goal.seeds = None;
    assert_eq!(refused(&goal), TargetError::NoSeeds);
    goal.seeds = Some(vec![(3, 3)]);
    let loose = refused(&goal);
    assert!(matches!(loose, TargetError::Loose(_)));
    // No block of the plate is under a cell of the plane.
    let help = loose.help().unwrap();
    assert!(help.starts_with("with 4 more cells, "), "{help}");
    assert!(help.ends_with(", it would be held"), "{help}");
}

#[test]
fn seeds_are_not_counted_as_free_blocks() {
    let corner = (0..12).map(|i| Cell::new((i + 1) % 6, (i + 1) / 6, 1));
    let corner: Vec<Cell> = corner.collect();
    let mut goal = goal(&corner, [20, 20]);
    goal.set_free(9).unwrap();
    let found = tried(&goal, 1).unwrap_err();
    let expected = TargetError::TooFewBlocks {
        needed: 12,
        free: 9,
    };
    assert!(
        matches!(&found, Unplanned::Refused(error) if *error == expected),
        "{found:?}"
    );
    goal.set_free(12).unwrap();
    assert!(tried(&goal, 1).is_ok());
}

/// Checks a bar between two walls, with blocks south of it. A seed in the north captures nothing.
/// It decides that free blocks come from the south.
#[test]
fn seeds_without_captures_are_obstacles_in_the_program() {
    let bar = (1..6).map(|x| Cell::new(x, 4, 1));
    let shape: Vec<Cell> = bar.chain([3, 2].map(|y| Cell::new(3, y, 1))).collect();
    let mut goal = goal(&shape, [6, 20]);
    goal.plate = Some(Plate { width: 6, depth: 8 });
    goal.seeds = Some(vec![(0, 4), (2, 7)]);
    let planned = tried(&goal, 1).unwrap();
    assert!(
        planned.text.contains("P[2, 7] at (2, 7)"),
        "{}",
        planned.text
    );
    let mut expected = shape;
    expected.sort_unstable();
    assert_eq!(built(&planned), expected);
}

/// Checks that a scene with four times as many free blocks has four times the area.
#[test]
fn larger_planar_scenes_keep_the_density() {
    let mut goal = goal(&[Cell::new(1, 0, 1)], [20, 20]);
    let larger = goal.set_free(240).unwrap().unwrap();
    for (_, length) in &larger.lengths {
        assert!((length - 8.0).abs() < 0.01, "{larger:?}");
    }
    assert!((larger.density - 1.0).abs() < 0.01, "{larger:?}");
}
