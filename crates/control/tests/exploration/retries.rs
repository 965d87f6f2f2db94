//! Tests that an aborted phase returns to its start, whenever it is aborted.
use stochc_control::explore::{
    Exploration, ExplorationBounds, ExplorationReport, ExplorationVerdict, Faults, ProgramGoals,
    Property,
};
use stochc_ir::table::Tables;
use stochc_runtime::counter_rng::schedules;

use crate::programs::{explore, explore_as, tables, tables_of};

/// Program with a branched structure, blocks from an earlier phase, and messages between branches.
const SPAN: &str = "
assembly span {
    seed plate 3 x 1 { A at (0, 0)  B at (2, 0) }
    phase feet { A.up -> F }
    phase span timeout 10 ticks {
        F.up -> C.up -> D.east -> E
        C.west -> W after G
        B.up -> G after C
    } on timeout { release span  retry 3 }
    phase top { E.up -> T }
}";

fn span() -> Tables {
    tables(SPAN)
}

/// Explores tables with the goals of other tables.
fn against(tables: &Tables, original: &Tables) -> ExplorationReport {
    let expected = ProgramGoals::new(original);
    let bounds = ExplorationBounds::default();
    Exploration::new(tables, &expected, bounds, Faults::default()).run()
}

fn violated(report: &ExplorationReport) -> Option<Property> {
    report.violation().map(|violation| violation.property)
}

#[test]
fn every_abort_returns_to_the_start_of_the_phase() {
    for tables in [vec![span()], tables_of("examples/five_tower_retried.sa")].concat() {
        let report = explore(&tables);
        assert_eq!(report.verdict, ExplorationVerdict::Holds);
    }
    let aborted = explore_as(&span(), |all| all.reduce = false);
    assert_eq!(aborted.verdict, ExplorationVerdict::Holds);
    let mut plain = span();
    plain.phases[1].recovery = None;
    let without = explore_as(&plain, |all| all.reduce = false);
    assert!(
        aborted.states > 2 * without.states,
        "{aborted:?} {without:?}"
    );
}

#[test]
fn the_table_contains_one_report_of_each_captor() {
    let recovery = span().phases[1].recovery.expect("the phase is retried");
    assert_eq!(
        (recovery.retries, recovery.reports, recovery.pause),
        (3, 2, 0)
    );
}

#[test]
fn a_retry_before_the_last_report_is_found() {
    let mut early = span();
    if let Some(recovery) = &mut early.phases[1].recovery {
        recovery.reports -= 1;
    }
    assert_eq!(
        violated(&against(&early, &span())),
        Some(Property::Recovery)
    );
}

#[test]
fn a_retry_that_waits_for_too_many_reports_hangs() {
    let mut late = span();
    if let Some(recovery) = &mut late.phases[1].recovery {
        recovery.reports += 1;
    }
    assert_eq!(violated(&against(&late, &span())), Some(Property::NoHang));
}

#[test]
fn lost_messages_delay_a_retry_only() {
    let report = explore_as(&span(), |all| all.faults.lost = 1);
    assert_eq!(report.verdict, ExplorationVerdict::Holds);
}

#[test]
fn a_failed_block_prevents_a_retry_only() {
    let report = explore_as(&span(), |all| {
        all.faults.dead = 1;
        all.hangs_allowed = true;
    });
    assert_eq!(report.verdict, ExplorationVerdict::Holds);
    assert!(report.hangs > 0);
}

#[test]
fn a_late_capture_in_an_aborted_phase_is_rejected() {
    let report = explore_as(&span(), |all| all.faults.strays = 1);
    assert_eq!(report.verdict, ExplorationVerdict::Holds);
}

/// Program whose phases can all be retried once.
const RETRIED: &str = "
assembly retried {
    seed plate 3 x 1 { A at (0, 0)  B at (2, 0) }
    phase feet timeout 10 ticks { A.up -> F } on timeout { release feet  retry 1 }
    phase span timeout 10 ticks {
        F.up -> C.up -> D
        C.west -> W after G
        B.up -> G after C
    } on timeout { release span  retry 1 }
}";

#[test]
fn as_many_retries_as_silent_blocks_are_enough() {
    for retries in [1, 2] {
        let text = RETRIED.replace("retry 1", &format!("retry {retries}"));
        let tables = tables(&text);
        for silent in [retries, retries + 1] {
            let report = explore_as(&tables, |all| all.faults.silent = silent);
            if silent == retries {
                assert_eq!(report.verdict, ExplorationVerdict::Holds);
            } else {
                assert_eq!(violated(&report), Some(Property::NoHang));
            }
        }
    }
}

#[test]
fn silent_blocks_and_lost_messages_delay_a_retry_only() {
    let report = explore_as(&tables(RETRIED), |all| {
        all.faults.silent = 1;
        all.faults.lost = 1;
        all.bounds.states = 3_000_000;
    });
    assert_eq!(report.verdict, ExplorationVerdict::Holds);
}

#[test]
fn random_orders_find_a_silent_block_that_is_not_survived() {
    let sampled = |retries: u8, silent: u8| {
        let tables = tables(&RETRIED.replace("retry 1", &format!("retry {retries}")));
        let expected = ProgramGoals::new(&tables);
        let faults = Faults {
            silent,
            ..Faults::default()
        };
        let bounds = ExplorationBounds::default();
        let all = Exploration::new(&tables, &expected, bounds, faults);
        all.sample(500, &mut schedules(1)).verdict
    };
    assert_eq!(sampled(2, 2), ExplorationVerdict::Sampled);
    assert!(matches!(
        sampled(1, 2),
        ExplorationVerdict::Violated(violation) if violation.property == Property::NoHang
    ));
}

#[test]
fn a_silent_block_is_named_in_the_trace() {
    let mut alone = tables(RETRIED);
    alone.phases[1].recovery = None;
    let report = explore_as(&alone, |all| all.faults.silent = 1);
    insta::assert_snapshot!(report.violation().unwrap());
}
