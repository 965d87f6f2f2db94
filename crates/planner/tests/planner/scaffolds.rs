//! Tests scaffolds: they are built, handed over and released, and used only if they save time.
use proptest::prelude::*;
use stochc_compiler::check_text;
use stochc_ir::record::Outcome;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_planner::{Goal, PlanSearch, Planned};
use stochc_runtime::{Model, Settings};

use crate::{compile, named, simulate};

fn on(mut goal: Goal, width: u32, depth: u32) -> Goal {
    goal.plate = Some(Plate { width, depth });
    goal
}

fn planned(goal: &Goal, rounds: u64, keeps_scaffolds: bool) -> Planned {
    let search = PlanSearch {
        rounds,
        seed: 5,
        keeps_scaffolds,
        ..PlanSearch::default()
    };
    goal.plan(&[], search).unwrap()
}

/// Checks that all runs complete. Returns their mean number of ticks.
fn executed(planned: &Planned, model: Model, runs: u64) -> f64 {
    let checked = check_text("planned.sa", &planned.text);
    assert!(checked.diagnostics.is_empty(), "{:?}", checked.diagnostics);
    let executables = compile(checked);
    let settings = Settings::new(model, 1);
    let ticks = (0..runs).map(|run| {
        let record = simulate(&executables[0], &settings, 23, run);
        assert_eq!(record.outcome, Outcome::Completed);
        record.ticks as f64
    });
    ticks.sum::<f64>() / runs as f64
}

#[test]
fn a_serpentine_grows_from_masts() {
    let goal = on(named("serpentine"), 10, 2);
    let plain = planned(&goal, 1, false);
    assert!(plain.plan.dismantling.is_none());
    let planned = planned(&goal, 3000, false);
    let dismantling = planned
        .plan
        .dismantling
        .as_ref()
        .expect("masts are faster here");
    assert!(planned.plan.estimate.mean < 0.6 * plain.plan.estimate.mean);
    let mut cells = goal.cells.clone();
    cells.sort_unstable();
    assert_eq!(planned.plan.cells(), cells);
    assert!(planned.text.contains("yields serpentine"));
    assert!(!dismantling.masts.is_empty());
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("program_serpentine", planned.text);
    });
    // Blocks that are handed over are captured twice.
    let explanation = stochc_planner::explanation(&planned.plan);
    let checked = check_text("planned.sa", &planned.text);
    let captures = checked.programs[0].plan.counts().0;
    assert!(
        explanation.starts_with(&format!("{captures} captures")),
        "{explanation}"
    );
    executed(&planned, Model::Shuffle, 3);
    // With physics, blocks that are handed over stay in place, so no other block has to arrive.
    let executables = compile(check_text("planned.sa", &planned.text));
    for run in 0..2 {
        let record = simulate(&executables[0], &Settings::default(), 4711, run);
        assert_eq!(record.outcome, Outcome::Completed);
        let stayed = record
            .bonds
            .iter()
            .filter(|bond| bond.docked - bond.magnetized <= 3)
            .count();
        assert!(stayed >= dismantling.hand_overs.len(), "{stayed}");
    }
}

#[test]
fn permanent_masts_are_claimed() {
    let goal = on(named("serpentine"), 10, 2);
    let planned = planned(&goal, 300, true);
    let cells = planned.plan.cells();
    assert!(cells.len() > goal.cells.len());
    assert!(
        goal.cells
            .iter()
            .all(|cell| cells.binary_search(cell).is_ok())
    );
    assert!(planned.text.contains("yields serpentine_with_scaffolds"));
    assert!(!planned.text.contains("release S"));
    executed(&planned, Model::Shuffle, 2);
}

#[test]
fn masts_are_built_only_if_they_save_time() {
    for (name, width, depth) in [("five_towers", 3, 3), ("cube", 6, 6)] {
        let planned = planned(&on(named(name), width, depth), 200, false);
        assert!(planned.plan.dismantling.is_none(), "{name}");
    }
}

#[test]
fn a_line_grows_beside_a_mast() {
    let goal = on(named("line"), 2, 1);
    let plain = planned(&goal, 1, false);
    let planned = planned(&goal, 200, false);
    let dismantling = planned.plan.dismantling.as_ref().expect("it is a wall");
    assert!(dismantling.hand_overs.is_empty());
    assert_eq!(dismantling.masts.len(), 1);
    assert!(planned.plan.estimate.mean < 0.95 * plain.plan.estimate.mean);
    assert_eq!(planned.plan.cells(), named("line").cells);
    executed(&planned, Model::Shuffle, 2);
}

/// Generates a walk that does not cross itself, from the middle of a plate.
fn walk() -> impl Strategy<Value = Vec<Cell>> {
    proptest::collection::vec(0..6u8, 10..60).prop_map(|steps| {
        let mut cells = vec![Cell::new(3, 3, 1)];
        for face in steps {
            let last = cells[cells.len() - 1];
            let next = last.across(Face::ALL[usize::from(face)]).unwrap();
            let inside = (0..8).contains(&next.x) && (0..8).contains(&next.y) && next.z >= 1;
            if inside && !cells.contains(&next) {
                cells.push(next);
            }
        }
        cells
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn walks_are_built_with_scaffolds_or_without(shape in walk(), retains: bool) {
        let goal = on(Goal::from_cells("walk", shape.clone()), 8, 8);
        let planned = planned(&goal, 60, retains);
        let mut expected = shape;
        expected.sort_unstable();
        if !retains {
            prop_assert_eq!(planned.plan.cells(), expected);
        }
        executed(&planned, Model::Shuffle, 2);
        executed(&planned, Model::Rate, 1);
    }
}
