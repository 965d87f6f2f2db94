//! Tests cells that blocks can or cannot reach.
use std::collections::BTreeSet;

use proptest::prelude::*;
use stochc_control::explore::{ExplorationVerdict, Property};
use stochc_ir::{Cell, Face};

use crate::programs::{explore, explore_as, fixed_cases, tables};
use crate::random::declare;

/// Three towers in a row. The middle one reaches two blocks only if its foot docks in time.
const WELL: &str = "
assembly well {
    seed plate 3 x 3 {
        A at (0, 1)  B at (2, 1)  C at (1, 0)  D at (1, 2)  M at (1, 1)
    }
    phase grow {
        A.up -> a[1].up -> a[2].east -> roof
        M.up -> foot
        B.up -> b  C.up -> c  D.up -> d
    }
}";

/// Returns whether a path of free cells leads from a cell to the outside.
fn can_come(occupied: &BTreeSet<Cell>, cell: Cell) -> bool {
    let outside =
        |cell: Cell| !(-1..=3).contains(&cell.x) || !(-1..=3).contains(&cell.y) || cell.z > 4;
    let mut seen = BTreeSet::from([cell]);
    let mut open = vec![cell];
    while let Some(cell) = open.pop() {
        if outside(cell) {
            return true;
        }
        for face in Face::ALL {
            let next = cell.across(face).unwrap();
            if next.z >= 1 && !occupied.contains(&next) && seen.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

#[test]
fn a_cell_that_is_closed_in_one_order_is_a_hang() {
    let well = tables(WELL);
    assert_eq!(explore(&well).verdict, ExplorationVerdict::Holds);
    for reduce in [true, false] {
        let report = explore_as(&well, |all| {
            all.reach = Some(&can_come);
            all.reduce = reduce;
        });
        let violation = report.violation().unwrap();
        assert_eq!(violation.property, Property::NoHang);
        let why = "M.up waits for foot at (1, 1, 1), which no block can reach";
        assert!(violation.what.contains(why), "{violation}");
        assert!(
            violation
                .trace
                .iter()
                .any(|line| line == "a[2].east captures roof")
        );
        assert!(
            violation
                .trace
                .iter()
                .all(|line| !line.contains("captures foot"))
        );
    }
}

#[test]
fn an_order_that_leaves_the_access_path_open_passes() {
    let well = tables(&WELL.replace("-> roof", "-> roof after foot").replace(
        "A.up -> a[1].up -> a[2].east -> roof after foot",
        "A.up -> a[1].up -> a[2]  a[2].east -> roof after foot",
    ));
    let explored = [true, false].map(|reduce| {
        explore_as(&well, |all| {
            all.reach = Some(&can_come);
            all.reduce = reduce;
        })
    });
    assert!(
        explored
            .iter()
            .all(|report| report.verdict == ExplorationVerdict::Holds)
    );
    assert!(explored[0].states * 10 < explored[1].states, "{explored:?}");
}

/// Returns whether a block that avoids corners can enter a cell: a cell next to two blocks is
/// closed.
fn can_fit(occupied: &BTreeSet<Cell>, cell: Cell) -> bool {
    let beside = |face: &Face| (cell.across(*face)).is_some_and(|next| occupied.contains(&next));
    Face::ALL.iter().filter(|face| beside(face)).count() < 2
}

/// If cells can become unreachable, the reduced exploration reaches the same hangs.
#[test]
fn the_reduction_finds_the_same_closed_cells() {
    let [hangs, full_states, reduced_states] = [(); 3].map(|()| std::cell::Cell::new(0));
    let mut runner = fixed_cases(200);
    let choices = prop::collection::vec(any::<u32>(), 0..40);
    let done = runner.run(&(choices, 1u8..=3), |(choices, faces)| {
        let tables = declare(choices, faces).tables();
        let [full, reduced] = [false, true].map(|reduce| {
            explore_as(&tables, |all| {
                all.reduce = reduce;
                all.hangs_allowed = true;
                all.bounds.states = 20_000;
                all.reach = Some(&can_fit);
            })
        });
        if !matches!(full.verdict, ExplorationVerdict::Unfinished(_)) {
            prop_assert_eq!(&full.verdict, &reduced.verdict);
            prop_assert_eq!(full.hangs, reduced.hangs);
            hangs.set(hangs.get() + full.hangs);
            full_states.set(full_states.get() + full.states);
            reduced_states.set(reduced_states.get() + reduced.states);
        }
        Ok(())
    });
    done.unwrap();
    let [hangs, full, reduced] =
        [hangs, full_states, reduced_states].map(std::cell::Cell::into_inner);
    println!("{hangs} hangs, {full} states in full, {reduced} reduced");
    assert!(hangs > 5, "{hangs}");
    assert!(reduced * 2 < full, "{reduced} of {full}");
}
