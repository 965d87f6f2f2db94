//! Tests times of releases and phases.
use std::ops::ControlFlow;

use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;
use stochc_runtime::{Model, Settings, run};

/// Runs a program that releases two blocks after some time.
fn record(model: Model, messages: &str) -> RunRecord {
    // The model `rapier` has no soft contacts.
    let scene = match model {
        Model::Rapier => "hemisphere_2005",
        _ => "hemisphere",
    };
    let text = format!(
        "scene here from {scene} {{ {messages} }}
        assembly timed in here {{
            seed plate 1 x 1 {{ M at (0, 0) }}
            phase grow {{
                M.up -> A.east -> B.east -> C
                release C after 400 ticks
                release B after 300 ticks
            }}
            phase settle {{ wait 700 ticks }}
            phase drop {{ release A after 1 ticks }}
        }}"
    );
    let mut reader = |_: &str| Ok(text.clone().into_bytes());
    let mut checked = stochc_compiler::check("timed.sa", &mut reader, Default::default());
    let program = checked.programs.remove(0);
    let (Some(tables), Some(scene)) = (program.tables, program.scene) else {
        panic!("{:#?}", checked.diagnostics)
    };
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    let settings = Settings::new(model, 1);
    run(&tables, &scene, &settings, 5, 0, &mut watch).expect("a valid scene")
}

#[test]
fn releases_and_phases_take_their_times() {
    for model in [Model::Rate, Model::Rigid, Model::Rapier, Model::Shuffle] {
        let record = record(model, "");
        assert_eq!(record.outcome, Outcome::Completed, "{model:?}");
        let captured = record.bonds[2].docked;
        let gone: Vec<u64> = record.releases.iter().map(|it| it.tick).collect();
        // C is released first, because it is a child of B.
        assert_eq!(gone[..2], [captured + 400, captured + 700], "{model:?}");
        assert_eq!(record.phase_ticks[0], captured + 700, "{model:?}");
        assert_eq!(record.phase_ticks[1], 700, "{model:?}");
        assert_eq!(record.phase_ticks[2], 1, "{model:?}");
    }
}

#[test]
fn messages_take_additional_time() {
    let record = record(Model::Shuffle, "messages { hop 3 ticks }");
    let captured = record.bonds[2].docked;
    let gone: Vec<u64> = record.releases.iter().map(|it| it.tick).collect();
    assert_eq!(gone[..2], [captured + 403, captured + 706]);
}

#[test]
fn lost_requests_are_sent_again() {
    let record = record(Model::Shuffle, "messages { hop 3 ticks  loss 60% }");
    assert_eq!(record.outcome, Outcome::Completed);
    assert!(record.releases[1].tick > record.bonds[2].docked + 706);
}
