//! Checks that valid programs complete in every order, and that the reduced exploration suffices.
use std::cell::Cell;

use proptest::prelude::*;
use stochc_control::explore::{
    ExceededBound, Exploration, ExplorationBounds, ExplorationVerdict, Faults, ProgramGoals,
};
use stochc_ir::table::PhaseId;
use stochc_runtime::counter_rng::schedules;

use crate::programs::{BUSY, ROOT, checked, explore, explore_as, fixed_cases, tables, tables_of};
use crate::random::declare;

#[test]
fn every_example_and_fixture_passes() {
    let mut count = 0;
    for folder in ["examples", "tests/fixtures"] {
        for entry in std::fs::read_dir(format!("{ROOT}/{folder}")).unwrap() {
            let name = entry.unwrap().file_name();
            let path = format!("{folder}/{}", name.to_str().unwrap());
            if checked(&path).has_errors() {
                continue;
            }
            for tables in tables_of(&path) {
                assert_eq!(
                    explore(&tables).verdict,
                    ExplorationVerdict::Holds,
                    "{path}"
                );
                count += 1;
            }
        }
    }
    assert!(count >= 12, "{count}");
}

#[test]
fn explores_all_orders_of_the_five_towers() {
    let [tables] = &tables_of("examples/five_tower.sa")[..] else {
        panic!("one assembly");
    };
    let full = explore_as(tables, |all| all.reduce = false);
    let reduced = explore(tables);
    assert_eq!(full.verdict, ExplorationVerdict::Holds);
    assert_eq!(reduced.verdict, ExplorationVerdict::Holds);
    // Four towers have five states each: waiting for either block, a report with two hops or one
    // hop left, no report. Then one tower passes through five such states, and the run ends.
    assert_eq!(full.states, 5_u64.pow(4) + 5 + 1);
    assert!(reduced.states < 30, "{}", reduced.states);
}

/// Prints the table of docs/validation/proofs-executed.md.
#[test]
fn states_and_transitions_with_and_without_the_reduction() {
    let mut programs = Vec::new();
    for path in [
        "examples/line.sa",
        "examples/five_tower.sa",
        "examples/five_tower_reconfigured.sa",
        "tests/fixtures/handed_over.sa",
    ] {
        programs.extend(tables_of(path));
    }
    programs.push(tables(BUSY));
    let mut table = String::from(
        "| assembly | states | transitions | states, reduced | transitions, reduced |\n\
         |---|--:|--:|--:|--:|\n",
    );
    for tables in &programs {
        let full = explore_as(tables, |all| {
            all.reduce = false;
            all.bounds.states = 20_000;
        });
        let reduced = explore(tables);
        assert_eq!(reduced.verdict, ExplorationVerdict::Holds);
        let counts = match full.verdict {
            ExplorationVerdict::Holds => format!("{} | {}", full.states, full.transitions),
            _ => format!("> {} | ", full.states - 1),
        };
        table.push_str(&format!(
            "| `{}` | {counts} | {} | {} |\n",
            tables.assembly, reduced.states, reduced.transitions
        ));
    }
    let text = include_str!("../../../../docs/validation/proofs-executed.md");
    assert!(
        text.contains(&table),
        "docs/validation/proofs-executed.md should hold\n{table}"
    );
}

#[test]
fn explores_twenty_concurrent_captures() {
    let text = "scene s from hemisphere { free 300 uniform }
        assembly field in s {
            seed plate 39 x 1 { for i in 0..19 { S[i] at (2 * i, 0) } }
            phase grow { for i in 0..19 { S[i].up -> T[i] } }
        }";
    let tables = tables(text);
    let reduced = explore(&tables);
    assert_eq!(reduced.verdict, ExplorationVerdict::Holds);
    assert_eq!(reduced.transitions, 20 * 2 + 1);
    // The limit excludes a search through all 3^20 states.
    let bounds = ExplorationBounds {
        states: 10_000,
        ..ExplorationBounds::default()
    };
    let full = explore_as(&tables, |all| {
        all.reduce = false;
        all.bounds = bounds;
    });
    assert_eq!(
        full.verdict,
        ExplorationVerdict::Unfinished(ExceededBound::States)
    );
    assert_eq!(full.states, 10_001);
}

#[test]
fn limits_are_respected() {
    let tables = tables(BUSY);
    for (bounds, bound) in [
        (
            ExplorationBounds {
                states: 5,
                ..ExplorationBounds::default()
            },
            ExceededBound::States,
        ),
        (
            ExplorationBounds {
                memory: 20_000,
                ..ExplorationBounds::default()
            },
            ExceededBound::Memory,
        ),
        (
            ExplorationBounds {
                work: 50,
                ..ExplorationBounds::default()
            },
            ExceededBound::Work,
        ),
    ] {
        let report = explore_as(&tables, |all| all.bounds = bounds);
        assert_eq!(report.verdict, ExplorationVerdict::Unfinished(bound));
    }
}

#[test]
fn random_walks_sample_large_programs() {
    let tables = tables(BUSY);
    let (expected, bounds, faults) = (
        ProgramGoals::new(&tables),
        ExplorationBounds::default(),
        Faults::default(),
    );
    let exploration = Exploration::new(&tables, &expected, bounds, faults);
    let report = exploration.sample(500, &mut schedules(3));
    assert_eq!(report.verdict, ExplorationVerdict::Sampled);
    assert_eq!(report.schedules, 500);
    assert_eq!(report, exploration.sample(500, &mut schedules(3)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_pass(
        choices in prop::collection::vec(any::<u32>(), 0..160),
        faces in 1u8..=5,
    ) {
        let declared = declare(choices, faces);
        let tables = declared.tables();
        let expected = ProgramGoals::new(&tables);
        let built: std::collections::BTreeMap<_, _> = expected
            .structure(PhaseId(tables.phases.len() as u32 - 1))
            .iter()
            .map(|(&role, &cell)| (tables.name(role).to_owned(), cell))
            .collect();
        prop_assert_eq!(built, declared.structure);
        let bounds = ExplorationBounds { states: 3_000, ..ExplorationBounds::default() };
        let report = stochc_control::explore::explore(&tables, &bounds, &Faults::default());
        match report.verdict {
            ExplorationVerdict::Holds | ExplorationVerdict::Unfinished(ExceededBound::States) => {}
            verdict => prop_assert!(false, "{}\n{verdict:#?}", declared.text),
        }
        let faults = Faults::default();
        let sampled = Exploration::new(&tables, &expected, bounds, faults).sample(20, &mut schedules(1));
        prop_assert_eq!(sampled.verdict, ExplorationVerdict::Sampled);
    }
}

/// Small programs in full: the reduction reaches the same result and the same hangs.
#[test]
fn the_reduction_finds_the_same() {
    let [full_states, reduced_states, compared] = [(); 3].map(|()| Cell::new(0));
    let mut runner = fixed_cases(300);
    let choices = prop::collection::vec(any::<u32>(), 0..40);
    let bounds = ExplorationBounds {
        states: 20_000,
        ..ExplorationBounds::default()
    };
    let done = runner.run(&(choices, 1u8..=3), |(choices, faces)| {
        let tables = declare(choices, faces).tables();
        let with = |reduce| {
            explore_as(&tables, |all| {
                all.bounds = bounds;
                all.hangs_allowed = true;
                all.reduce = reduce;
            })
        };
        let (full, reduced) = (with(false), with(true));
        if matches!(full.verdict, ExplorationVerdict::Unfinished(_)) {
            return Ok(());
        }
        prop_assert_eq!(&full.verdict, &reduced.verdict);
        prop_assert_eq!(full.hangs, reduced.hangs);
        prop_assert!(reduced.states <= full.states);
        compared.set(compared.get() + 1);
        full_states.set(full_states.get() + full.states);
        reduced_states.set(reduced_states.get() + reduced.states);
        Ok(())
    });
    done.unwrap();
    let [full_states, reduced_states, compared] =
        [full_states, reduced_states, compared].map(Cell::into_inner);
    println!("{compared} programs: {full_states} states in full, {reduced_states} reduced");
    assert!(compared > 200, "{compared}");
    assert!(
        reduced_states * 3 < full_states * 2,
        "{reduced_states} of {full_states}"
    );
}
