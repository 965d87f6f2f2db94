//! Tests which faults the protocol survives, and the consequences of the others.
use std::cell::Cell;
use std::collections::BTreeSet;

use proptest::prelude::*;
use stochc_control::explore::{
    Exploration, ExplorationBounds, ExplorationReport, ExplorationVerdict, Faults, ProgramGoals,
    Property, Violation,
};
use stochc_ir::table::Tables;
use stochc_runtime::counter_rng::schedules;

use crate::programs::{BUSY, explore_as, fixed_cases, tables, tables_of};
use crate::random::declare;

const NONE: Faults = Faults {
    lost: 0,
    sent_again: true,
    dead: 0,
    silent: 0,
    strays: 0,
    stuck: false,
    mistaken: 0,
};

fn programs() -> Vec<Tables> {
    let mut programs = tables_of("examples/five_tower_reconfigured.sa");
    programs.extend(tables_of("tests/fixtures/tower.sa"));
    programs.extend(tables_of("tests/fixtures/handed_over.sa"));
    programs.push(tables(BUSY));
    programs
}

/// Returns programs that are small enough to explore all orders.
fn small() -> Vec<Tables> {
    let mut programs = tables_of("examples/five_tower_reconfigured.sa");
    programs.extend(tables_of("tests/fixtures/tower.sa"));
    programs
}

fn with(tables: &Tables, faults: Faults) -> ExplorationReport {
    explore_as(tables, |all| all.faults = faults)
}

/// Explores a program and counts a hang as a regular end.
fn with_hangs(tables: &Tables, faults: Faults) -> ExplorationReport {
    explore_as(tables, |all| {
        all.faults = faults;
        all.hangs_allowed = true;
    })
}

#[test]
fn survives_lost_messages() {
    for tables in programs() {
        for lost in [1, 2] {
            let report = with(&tables, Faults { lost, ..NONE });
            assert_eq!(
                report.verdict,
                ExplorationVerdict::Holds,
                "{}",
                tables.assembly
            );
        }
    }
}

#[test]
fn without_resending_a_lost_message_only_hangs() {
    let faults = Faults {
        lost: 1,
        sent_again: false,
        ..NONE
    };
    for tables in programs() {
        let report = with(&tables, faults);
        let violation = report.violation().expect("a loss that matters");
        assert_eq!(violation.property, Property::NoHang);
        assert!(violation.trace.iter().any(|line| line.contains(" is lost")));
    }
    let report = with_hangs(&tables(BUSY), faults);
    assert_eq!(report.verdict, ExplorationVerdict::Holds);
    assert!(report.hangs > 0);
}

#[test]
fn a_dead_block_only_hangs() {
    let dead = Faults { dead: 1, ..NONE };
    // If blocks can die, all orders are explored. That is too much for the larger programs, which
    // use random orders.
    for tables in small() {
        let report = with_hangs(&tables, dead);
        assert_eq!(
            report.verdict,
            ExplorationVerdict::Holds,
            "{}",
            tables.assembly
        );
        assert!(report.hangs > 0);
        let report = with(&tables, dead);
        let violation = report.violation().expect("a death that matters");
        assert_eq!(violation.property, Property::NoHang);
        assert!(violation.trace.iter().any(|line| line.ends_with(" dies")));
    }
    for tables in programs() {
        let expected = ProgramGoals::new(&tables);
        let mut exploration =
            Exploration::new(&tables, &expected, ExplorationBounds::default(), dead);
        exploration.hangs_allowed = true;
        let report = exploration.sample(500, &mut schedules(1));
        assert_eq!(
            report.verdict,
            ExplorationVerdict::Sampled,
            "{}",
            tables.assembly
        );
        assert!(report.hangs > 0);
    }
    let two = Faults { dead: 2, ..NONE };
    let report = with_hangs(&tables_of("tests/fixtures/tower.sa")[0], two);
    assert_eq!(report.verdict, ExplorationVerdict::Holds);
}

#[test]
fn survives_a_block_that_dies_when_idle() {
    let tables =
        tables("assembly one { seed plate 1 x 1 { M at (0, 0) } phase only { M.up -> A } }");
    let dead = Faults { dead: 1, ..NONE };
    let report = with_hangs(&tables, dead);
    // A reports at its capture and may die afterwards.
    assert_eq!(
        (report.verdict, report.hangs),
        (ExplorationVerdict::Holds, 0)
    );
}

#[test]
fn a_silent_block_only_hangs_without_retries() {
    for tables in small() {
        for silent in [1, 2] {
            let report = with_hangs(&tables, Faults { silent, ..NONE });
            assert_eq!(
                report.verdict,
                ExplorationVerdict::Holds,
                "{}",
                tables.assembly
            );
            assert!(report.hangs > 0);
        }
        let silent = Faults { silent: 1, ..NONE };
        let violation = with(&tables, silent).violation().cloned().unwrap();
        assert_eq!(violation.property, Property::NoHang);
        assert!(violation.what.contains("whose block does not answer"));
    }
}

#[test]
fn survives_an_unplanned_bond() {
    let stray = Faults { strays: 1, ..NONE };
    // All orders are explored until the stray docks. That is too much for the larger programs.
    for tables in small() {
        let report = with(&tables, stray);
        assert_eq!(
            report.verdict,
            ExplorationVerdict::Holds,
            "{}",
            tables.assembly
        );
        assert!(report.choices > 10);
    }
}

#[test]
fn a_permanent_unplanned_bond_obstructs_or_stays() {
    let stuck = Faults {
        strays: 1,
        stuck: true,
        ..NONE
    };
    // The eastern face of A is off until B has docked.
    let corner = tables(
        "assembly corner {
            seed plate 1 x 1 { M at (0, 0) }
            phase only { M.up -> A.up -> B  A.east -> C }
        }",
    );
    let (expected, bounds) = (ProgramGoals::new(&corner), ExplorationBounds::default());
    let exploration = Exploration::new(&corner, &expected, bounds, stuck);
    let violations: Vec<Violation> = (0..200)
        .filter_map(|seed| {
            exploration
                .sample(1, &mut schedules(seed))
                .violation()
                .cloned()
        })
        .collect();
    let found: BTreeSet<Property> = violations.iter().map(|found| found.property).collect();
    assert_eq!(
        found,
        BTreeSet::from([Property::NoHang, Property::Structure])
    );
    for violation in violations {
        let what = match violation.property {
            Property::NoHang => "which is occupied",
            _ => "with a block without a role",
        };
        assert!(violation.what.contains(what), "{violation}");
    }
}

#[test]
fn a_block_with_wrong_orientation_builds_another_shape() {
    let mistaken = Faults {
        mistaken: 1,
        ..NONE
    };
    let tower = &tables_of("tests/fixtures/tower.sa")[0];
    let violation = with_hangs(tower, mistaken).violation().cloned().unwrap();
    assert_eq!(violation.property, Property::Structure);
    insta::assert_snapshot!(violation);
    // A block that captures nothing does not use its orientation.
    let one = tables("assembly one { seed plate 1 x 1 { M at (0, 0) } phase only { M.up -> A } }");
    assert_eq!(with(&one, mistaken).verdict, ExplorationVerdict::Holds);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_survive_lost_messages_and_outlast_dead_blocks(
        choices in prop::collection::vec(any::<u32>(), 0..60),
        faces in 1u8..=3,
    ) {
        let tables = declare(choices, faces).tables();
        let faults = [
            Faults { lost: 1, ..NONE },
            Faults { dead: 1, ..NONE },
            Faults { silent: 2, ..NONE },
        ];
        for faults in faults {
            let report = explore_as(&tables, |all| {
                all.faults = faults;
                all.hangs_allowed = faults.lost == 0;
                all.bounds = ExplorationBounds { states: 5_000, ..ExplorationBounds::default() };
            });
            if let Some(violation) = report.violation() {
                prop_assert!(false, "{faults:?}\n{violation}");
            }
        }
    }
}

/// With lost messages, the reduction still reaches the same results as the full exploration.
#[test]
fn the_reduction_finds_the_same_with_losses() {
    let compared = Cell::new(0);
    let mut runner = fixed_cases(100);
    let choices = prop::collection::vec(any::<u32>(), 0..24);
    let done = runner.run(&(choices, any::<bool>()), |(choices, sent_again)| {
        let tables = declare(choices, 1).tables();
        let explored = [false, true].map(|reduce| {
            explore_as(&tables, |all| {
                all.reduce = reduce;
                all.hangs_allowed = true;
                all.bounds.states = 20_000;
                all.faults = Faults {
                    lost: 1,
                    sent_again,
                    ..NONE
                };
            })
        });
        let [full, reduced] = &explored;
        if !matches!(full.verdict, ExplorationVerdict::Unfinished(_)) {
            prop_assert_eq!(&full.verdict, &reduced.verdict);
            prop_assert_eq!(full.hangs, reduced.hangs);
            compared.set(compared.get() + 1);
        }
        Ok(())
    });
    done.unwrap();
    assert!(compared.get() > 50, "{}", compared.get());
}
