//! Tests runs that abort a phase and begin it again.
use std::ops::ControlFlow;

use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_runtime::{Model, Settings, run};

/// Runs a program with two towers, whose second phase has this timeout and pause \[ticks\].
fn record(model: Model, timeout: u64, pause: &str, number: u64) -> RunRecord {
    // The model `rapier` has no soft contacts.
    let scene = match model {
        Model::Rapier => "hemisphere_2005",
        _ => "hemisphere",
    };
    let text = format!(
        "assembly towers in {scene} {{
            seed plate 3 x 1 {{ A at (0, 0)  B at (2, 0) }}
            phase feet {{ A.up -> C  B.up -> D }}
            phase tops timeout {timeout} ticks {{
                C.up -> E.up -> F
                D.up -> G
            }} on timeout {{ release tops {pause} retry 4 }}
        }}"
    );
    let mut reader = |_: &str| Ok(text.clone().into_bytes());
    let mut checked = stochc_compiler::check("towers.sa", &mut reader, Default::default());
    let program = checked.programs.remove(0);
    let (Some(tables), Some(scene)) = (program.tables, program.scene) else {
        panic!("{:#?}", checked.diagnostics)
    };
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    run(
        &tables,
        &scene,
        &Settings::new(model, 1),
        5,
        number,
        &mut watch,
    )
    .expect("a valid scene")
}

/// Returns whether all captures of every aborted attempt are released, children first.
fn is_undone(record: &RunRecord) -> bool {
    record.aborts.iter().all(|abort| {
        let captured: Vec<u32> = abort.bonds.iter().map(|bond| bond.body).collect();
        let mut released: Vec<u32> = abort.releases.iter().map(|it| it.body).collect();
        let place = |child| abort.releases.iter().position(|it| it.child == child);
        let is_ordered = (abort.bonds.iter())
            .all(|bond| place(bond.parent).is_none_or(|parent| place(bond.child) < Some(parent)));
        let mut captured_sorted = captured;
        captured_sorted.sort_unstable();
        released.sort_unstable();
        captured_sorted == released && is_ordered
    })
}

#[test]
fn an_aborted_phase_is_undone_and_begins_again() {
    for (model, timeout) in [
        (Model::Rate, 1500),
        (Model::Rigid, 1500),
        (Model::Rapier, 1500),
    ] {
        let records: Vec<RunRecord> = (0..6)
            .map(|number| record(model, timeout, "wait 50 ticks", number))
            .collect();
        let retried = |record: &&RunRecord| record.retries(PhaseId(1)) > 0;
        let completed = |record: &RunRecord| record.outcome == Outcome::Completed;
        let both = records.iter().filter(retried).any(completed);
        assert!(both, "{model:?}: no run completes after a retry");
        for record in &records {
            assert!(is_undone(record), "{model:?}: {record:#?}");
            for abort in &record.aborts {
                assert_eq!(abort.tick - abort.began, timeout);
                assert_eq!(abort.retried.map(|tick| tick - abort.tick), Some(50));
                assert!(!abort.waiting.is_empty());
            }
            if completed(record) {
                assert_eq!(record.phase_ticks.iter().sum::<u64>(), record.ticks);
                assert_eq!(record.bonds.len(), 5);
            }
        }
    }
}

#[test]
fn the_last_attempt_times_out() {
    // One capture needs a tick, so the three captures of a phase take longer than one tick.
    let record = record(Model::Rate, 1, "", 0);
    let (phase, by) = (PhaseId(1), Limit::Timeout);
    assert_eq!(record.outcome, Outcome::TimedOut { phase, by });
    assert_eq!(record.aborts.len(), 4);
    assert_eq!(record.retries(phase), 4);
    assert_eq!(record.ticks, record.phase_ticks[0] + 5);
}

/// In the model `shuffle`, each tick has one capture, so three captures never fit into two ticks.
#[test]
fn every_attempt_without_physics_is_undone() {
    let record = record(Model::Shuffle, 2, "wait 5 ticks", 0);
    let (phase, by) = (PhaseId(1), Limit::Timeout);
    assert_eq!(record.outcome, Outcome::TimedOut { phase, by });
    assert!(is_undone(&record), "{record:#?}");
    let captures: Vec<usize> = record
        .aborts
        .iter()
        .map(|abort| abort.bonds.len())
        .collect();
    assert_eq!(captures, [2; 4]);
}

#[test]
fn a_run_with_retries_is_reproducible() {
    let runs = || (0..3).map(|number| record(Model::Rigid, 1000, "", number));
    assert!(runs().any(|record| !record.aborts.is_empty()));
    assert!(runs().eq(runs()));
}
