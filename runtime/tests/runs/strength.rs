//! Tests bonds that break under the weight of the blocks beyond them.
use std::ops::ControlFlow;

use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_runtime::{Model, Settings, run};

/// Runs a program in a scene with this strength of bonds. A block weighs 1 N, and its edge is 10 cm.
/// `plate` is the content of the seed plate, and `fluid` a clause of the scene.
fn record(strength: &str, fluid: &str, plate: &str, program: &str) -> RunRecord {
    let text = format!(
        "scene tank from hemisphere {{
            block cube {{ side 10cm  mass 1kg }}
            gravity 1 m/s^2  {fluid}
            bond attract {{ pull 2 N within 10cm  anchor centres 1mm  strength {{ {strength} }} }}
        }}
        assembly crane in tank {{ seed plate 1 x 1 {{ M at (0, 0)  {plate} }} {program} }}"
    );
    let mut reader = |_: &str| Ok(text.clone().into_bytes());
    let mut checked = stochc_compiler::check("crane.sa", &mut reader, Default::default());
    let program = checked.programs.remove(0);
    let (Some(tables), Some(scene)) = (program.tables, program.scene) else {
        panic!("{:#?}", checked.diagnostics)
    };
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    let settings = Settings::new(Model::Shuffle, 1);
    run(&tables, &scene, &settings, 3, 0, &mut watch).expect("a valid scene")
}

/// Column of two blocks with an arm of three. The floor carries the first block.
const CRANE: &str = "phase grow { M.up -> A.up -> B.east -> C.east -> D.east -> E }";

fn broken(record: &RunRecord) -> (usize, &str) {
    match &record.outcome {
        Outcome::Failed {
            reason,
            is_broken: true,
            ..
        } => (record.bonds.len(), reason),
        outcome => panic!("{outcome:?}"),
    }
}

#[test]
fn a_bond_breaks_at_the_capture_that_overloads_it() {
    // With n blocks in the arm, the bond of C carries n² 0.05 N m. The bond of B carries less.
    for (torque, captures) in [("0.19 N m", 4), ("0.21 N m", 5), ("0.44 N m", 5)] {
        let record = record(&format!("torque {torque}"), "", "", CRANE);
        let (count, reason) = broken(&record);
        assert_eq!(count, captures, "{torque}: {reason}");
        assert!(
            reason.starts_with("the bond of `C` broke under its load"),
            "{reason}"
        );
    }
    assert_eq!(
        record("torque 0.46 N m", "", "", CRANE).outcome,
        Outcome::Completed
    );
    // The arm shears with 3 N. The column presses on its parent.
    let record_of = |force| record(&format!("force {force}"), "", "", CRANE);
    assert_eq!(record_of("3.1 N").outcome, Outcome::Completed);
    let record = record_of("2.9 N");
    let load = "the bond of `C` broke under its load: 3 blocks, 3 N of 2.9 N";
    assert_eq!(broken(&record), (5, load));
}

#[test]
fn a_pre_attached_arm_breaks_before_the_first_tick() {
    let arm = "M.up -> A.up -> B.east -> C.east -> D";
    let record = record("torque 0.19 N m", "", arm, "phase grow { D.up -> E }");
    let (count, reason) = broken(&record);
    assert_eq!((record.ticks, count), (0, 4));
    assert!(reason.starts_with("the bond of `C`"), "{reason}");
}

/// Checks a balanced beam of rising blocks that loses one of its arms.
#[test]
fn a_release_of_a_counterweight_breaks_a_bond() {
    let beam = "phase near { M.up -> C  C.east -> E  C.west -> W }
        phase far { E.east -> F  W.west -> V }
        phase drop { release V  release W after release V }";
    let fluid = "fluid { density 2000 kg/m^3 }";
    let record = |torque| record(&format!("torque {torque} N m"), fluid, "", beam);
    assert_eq!(record(0.31).outcome, Outcome::Completed);
    let record = record(0.25);
    let (count, reason) = broken(&record);
    assert_eq!((count, record.releases.len()), (5, 2), "{reason}");
    assert!(reason.starts_with("the bond of `C`"), "{reason}");
}
