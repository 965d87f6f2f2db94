//! Tests hardware faults of scenes: dead blocks, and latches that fail.
use std::ops::ControlFlow;

use stochc_ir::record::{FaultKind, Limit, Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_runtime::{Model, Settings, run};

const MODELS: [Model; 4] = [Model::Rate, Model::Rigid, Model::Rapier, Model::Shuffle];

/// Runs a tower on a pre-attached block in a scene with these faults, for at most `limit` ticks.
fn record(model: Model, faults: &str, recovery: &str, limit: u64, number: u64) -> RunRecord {
    // The model `rapier` has no soft contacts.
    let scene = match model {
        Model::Rapier => "hemisphere_2005",
        _ => "hemisphere",
    };
    let text = format!(
        "scene tank from {scene} {{ {faults} }}
        assembly tower in tank {{
            seed plate 1 x 1 {{ M at (0, 0)  M.up -> A }}
            phase grow {recovery}
        }}"
    );
    let mut reader = |_: &str| Ok(text.clone().into_bytes());
    let mut checked = stochc_compiler::check("tower.sa", &mut reader, Default::default());
    let program = checked.programs.remove(0);
    let (Some(tables), Some(scene)) = (program.tables, program.scene) else {
        panic!("{:#?}", checked.diagnostics)
    };
    let mut settings = Settings::new(model, 1);
    settings.max_ticks = Some(limit);
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    run(&tables, &scene, &settings, 3, number, &mut watch).expect("a valid scene")
}

const ONCE: &str = "{ A.up -> B.up -> C }";

const RETRIED: &str = "timeout 1500 ticks { A.up -> B.up -> C }
    on timeout { release grow  wait 200 ticks  retry 20 }";

fn count(record: &RunRecord, kind: FaultKind) -> usize {
    record.faults.iter().filter(|it| it.kind == kind).count()
}

#[test]
fn a_dead_block_stays_at_its_face_and_its_phase_never_ends() {
    for model in MODELS {
        let record = record(model, "faults { dead 100% }", ONCE, 5_000, 0);
        let (phase, by) = (PhaseId(1), Limit::MaxTicks);
        assert_eq!(record.outcome, Outcome::TimedOut { phase, by }, "{model:?}");
        // The pre-attached block works, and the first free block stays.
        assert_eq!(record.bonds.len(), 1, "{model:?}");
        assert_eq!(record.faults.len(), 1, "{model:?}");
        assert_eq!(count(&record, FaultKind::Dead), 1, "{model:?}");
        assert_eq!(record.waiting.len(), 1, "{model:?}");
    }
}

#[test]
fn a_retry_releases_dead_blocks() {
    for model in [Model::Rate, Model::Rigid, Model::Rapier] {
        let records = (0..6).map(|run| record(model, "faults { dead 30% }", RETRIED, 40_000, run));
        let records: Vec<RunRecord> = records.collect();
        let is_survived =
            |it: &RunRecord| it.outcome == Outcome::Completed && count(it, FaultKind::Dead) > 0;
        assert!(records.iter().any(is_survived), "{model:?}");
        for record in &records {
            // Each dead block ends an attempt.
            assert!(
                record.aborts.len() >= count(record, FaultKind::Dead),
                "{model:?}"
            );
            let dead: Vec<u32> = record.faults.iter().map(|fault| fault.body).collect();
            let mut bonds = record.all_bonds();
            assert!(bonds.all(|bond| !dead.contains(&bond.body)), "{model:?}");
        }
    }
}

#[test]
fn a_failed_latch_only_delays_a_capture() {
    for model in MODELS {
        let mut failed = 0;
        for number in 0..6 {
            let record = record(model, "faults { latch 50% }", ONCE, 60_000, number);
            assert_eq!(record.outcome, Outcome::Completed, "{model:?}");
            assert_eq!(record.bonds.len(), 3, "{model:?}");
            assert_eq!(count(&record, FaultKind::Dead), 0, "{model:?}");
            failed += count(&record, FaultKind::Latch);
        }
        // A capture fails once on average, and each run has two.
        assert!((4..=36).contains(&failed), "{model:?}: {failed}");
    }
}

#[test]
fn the_number_of_faults_matches_their_probabilities() {
    let runs = 1_000;
    let (mut dead, mut latches, mut captures) = (0, 0, 0);
    for number in 0..runs {
        let record = record(
            Model::Shuffle,
            "faults { dead 20%  latch 30% }",
            ONCE,
            200,
            number,
        );
        dead += count(&record, FaultKind::Dead);
        latches += count(&record, FaultKind::Latch);
        captures += record.bonds.len() - 1;
    }
    let near = |part: usize, of: usize, expected: f64| {
        let error = (expected * (1.0 - expected) / of as f64).sqrt();
        let found = part as f64 / of as f64;
        assert!(
            (found - expected).abs() < 4.0 * error,
            "{found}, {expected}"
        );
    };
    // Without retries, each held block is new.
    near(dead, dead + captures, 0.2);
    near(latches, latches + dead + captures, 0.3);
}

#[test]
fn faults_that_never_happen_change_nothing() {
    for model in MODELS {
        for recovery in [ONCE, RETRIED] {
            let with = record(model, "faults { dead 0  latch 0 }", recovery, 6_000, 1);
            assert_eq!(with, record(model, "", recovery, 6_000, 1), "{model:?}");
        }
    }
}
