//! Checks that random shapes are built, or rejected with a reason.
use proptest::prelude::*;
use stochc_ir::Cell;
use stochc_ir::table::Plate;
use stochc_planner::TargetError;
use stochc_planner::{Goal, Unplanned};

use crate::{cells, tried};

/// Generates connected cells that touch the plate.
pub fn grown() -> impl Strategy<Value = Vec<Cell>> {
    proptest::collection::vec((any::<u16>(), 0..6u8), 0..40).prop_map(|steps| {
        let mut cells = vec![Cell::new(0, 0, 1)];
        for (from, face) in steps {
            let from = cells[usize::from(from) % cells.len()];
            let next = from
                .across(stochc_ir::Face::ALL[usize::from(face)])
                .unwrap();
            if next.z >= 1 && !cells.contains(&next) {
                cells.push(next);
            }
        }
        cells
    })
}

/// Generates arbitrary cells, close together.
fn scattered() -> impl Strategy<Value = Vec<Cell>> {
    let cell = (0..4, 0..4, 0..4).prop_map(|(x, y, z)| Cell::new(x, y, z));
    proptest::collection::vec(cell, 0..30)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn connected_shapes_are_built(shape in grown(), rounds in 1u64..8) {
        let goal = Goal::from_cells("grown", shape.clone());
        let planned = tried(&goal, rounds).unwrap();
        let mut expected = shape;
        expected.sort_unstable();
        prop_assert_eq!(cells(&planned.plan), expected);
    }

    #[test]
    fn any_shape_is_planned_or_rejected(shape in scattered(), seeds in proptest::collection::vec((0..4, 0..4), 0..4)) {
        let mut goal = Goal::from_cells("any", shape);
        goal.plate = Some(Plate { width: 4, depth: 4 });
        goal.seeds = (!seeds.is_empty()).then_some(seeds);
        match tried(&goal, 3) {
            Ok(_) => {}
            Err(Unplanned::Refused(error)) => {
                prop_assert!(!matches!(error, TargetError::Sealed(_) | TargetError::Cancelled), "{}", error);
            }
            Err(Unplanned::Wrong(checked)) => prop_assert!(false, "{:?}", checked.diagnostics),
        }
    }
}
