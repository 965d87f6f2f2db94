//! Tests hardware whose faces always attract, and pre-attached blocks.
use stochc_control::explore::{ExplorationVerdict, Faults, Property};
use stochc_ir::scene::BondKind;

use crate::programs::{BUSY, explore, explore_as, tables, tables_of};

/// Returns programs with releases, reused names and messages.
fn passive() -> Vec<stochc_ir::table::Tables> {
    let mut all = vec![tables(BUSY)];
    for path in [
        "examples/five_tower.sa",
        "examples/five_tower_reconfigured.sa",
        "tests/fixtures/handed_over.sa",
    ] {
        all.extend(tables_of(path));
    }
    for tables in &mut all {
        tables.bond = BondKind::Reject;
    }
    all
}

#[test]
fn an_unplanned_bond_changes_nothing_at_any_moment() {
    for tables in passive() {
        assert_eq!(
            explore(&tables).verdict,
            ExplorationVerdict::Holds,
            "{}",
            tables.assembly
        );
    }
}

#[test]
fn a_permanent_unplanned_bond_is_found() {
    for tables in passive() {
        let report = explore_as(&tables, |all| {
            all.faults = Faults {
                stuck: true,
                ..Faults::default()
            }
        });
        let violation = report.violation().expect("a stray that cannot be released");
        assert_eq!(violation.property, Property::Unplanned, "{violation}");
        assert!(
            violation.what.starts_with("an unplanned bond on "),
            "{violation}"
        );
    }
}

#[test]
fn pre_attached_blocks_exist_before_the_first_event() {
    for tables in tables_of("tests/fixtures/attached.sa") {
        assert!(tables.phases[0].pre_attached);
        assert_eq!(explore(&tables).verdict, ExplorationVerdict::Holds);
        // The first possible event is the first capture of the first ordinary phase.
        let mut early = tables.clone();
        early.phases[1].reports = 0;
        let violation = explore(&early).violation().cloned().expect("ends early");
        assert_eq!(violation.phase.0, 1);
        assert_eq!(violation.trace[0], "A.east captures B", "{violation}");
    }
}
