//! Checks that a run resumed from a checkpoint equals the uninterrupted run to the bit.
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::Read;
use std::ops::ControlFlow;

use stochc_compiler::{Limits, check};
use stochc_ir::Executable;
use stochc_ir::record::RunRecord;
use stochc_ir::scene::{Faults, Messages};
use stochc_ir::state::{StateError, StateReader, StateWriter};
use stochc_ir::table::PhaseId;
use stochc_runtime::observe::{ObservedEvent, Observer};
use stochc_runtime::world::SpatialWorld;
use stochc_runtime::{
    Model, Precision, Reduction, RunError, Save, Settings, Substeps, Watch, observe, run,
};

const SEED: u64 = 11;

/// Returns the programs of an example.
fn programs(text: &str) -> Vec<Executable> {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = check("program.sa", &mut reader, Limits::default());
    let programs = checked.programs.into_iter();
    programs
        .map(|program| program.into_executable().expect("the program is valid"))
        .collect()
}

/// Saves the state of a run every `every` ticks. It can start a run from a state.
#[derive(Default)]
struct Keeper {
    every: u64,
    /// Last tick of the run, after which it stops as if it was killed.
    last: Option<u64>,
    begins_with: Option<Vec<u8>>,
    tick: u64,
    saved: Vec<(u64, Vec<u8>)>,
}

impl Watch for Keeper {
    fn tick(&mut self, tick: u64, _phase: PhaseId) -> ControlFlow<()> {
        self.tick = tick;
        match self.last {
            Some(last) if tick > last => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }

    fn saved(&mut self) -> Option<Box<dyn Read>> {
        let state = self.begins_with.take()?;
        Some(Box::new(std::io::Cursor::new(state)))
    }

    fn wants_state(&mut self) -> bool {
        let before = self.saved.last().map_or(0, |(tick, _)| *tick);
        self.every > 0 && self.tick - before >= self.every
    }

    fn keep(&mut self, save: &mut Save<'_>) {
        let mut bytes = Vec::new();
        save(&mut StateWriter::new(&mut bytes)).expect("a checkpoint");
        self.saved.push((self.tick, bytes));
    }
}

/// Digest of all positions and events for each tick.
#[derive(Default)]
struct Digests(BTreeMap<u64, u64>);

impl Observer for Digests {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        let mut hasher = DefaultHasher::new();
        for id in 0..arena.count() {
            let state = arena.state(id);
            let vectors = [state.position, state.velocity, state.spin];
            let numbers = vectors.iter().flat_map(|vector| vector.iter());
            for number in numbers.chain(state.orientation.coords.iter()) {
                number.to_bits().hash(&mut hasher);
            }
        }
        format!("{events:?}").hash(&mut hasher);
        self.0.insert(arena.tick(), hasher.finish());
    }

    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        to.put(&self.0)
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.0 = from.take()?;
        Ok(())
    }
}

/// Makes a run. Observes all positions if the model has positions.
fn made(
    of: &Executable,
    settings: &Settings,
    watch: &mut Keeper,
) -> Result<(RunRecord, Digests), RunError> {
    let (tables, scene) = (&of.tables, &of.scene);
    let mut digests = Digests::default();
    let record = if settings.model.has_places() {
        observe(tables, scene, settings, SEED, 0, watch, &mut digests)?
    } else {
        run(tables, scene, settings, SEED, 0, watch)?
    };
    Ok((record, digests))
}

/// Resumes a run from each of its checkpoints. Returns the number of checkpoints.
fn resumed_everywhere(of: &Executable, settings: &Settings, every: u64) -> usize {
    let mut straight = Keeper::default();
    let (whole, digests) = made(of, settings, &mut straight).expect("the command starts");
    let mut keeper = Keeper {
        every,
        ..Keeper::default()
    };
    let (with_checkpoints, _) = made(of, settings, &mut keeper).expect("the command starts");
    assert_eq!(
        with_checkpoints, whole,
        "{settings:?}: checkpoints change a run"
    );
    let states = keeper.saved.len();
    for (tick, state) in keeper.saved {
        let mut resumed = Keeper {
            begins_with: Some(state),
            ..Keeper::default()
        };
        let (record, places) = made(of, settings, &mut resumed).expect("the run continues");
        let what = format!("{settings:?} from tick {tick}");
        assert!(record == whole, "{what}: {:?}", record.outcome);
        assert!(places.0 == digests.0, "{what}: other positions");
    }
    states
}

fn rigid() -> Settings {
    Settings {
        max_ticks: Some(700),
        ..Settings::new(Model::Rigid, 1)
    }
}

fn everywhere(text: &str, settings: &[Settings], every: u64) {
    for program in programs(text) {
        for settings in settings {
            let states = resumed_everywhere(&program, settings, every);
            assert!(states > 1, "{settings:?}: {states}");
        }
    }
}

const TOWER: &str = include_str!("../../../examples/five_tower_reconfigured.sa");

#[test]
fn rigid_blocks_in_all_steps_and_reductions() {
    let mut cases = vec![
        rigid(),
        rigid().with_steps(Substeps::DEFAULT),
        Settings {
            precision: Precision::Double,
            ..rigid().with_steps(Substeps::DEFAULT)
        },
    ];
    cases.extend(Reduction::ALL.map(|reduction| Settings {
        reduction: Some(reduction),
        ..rigid()
    }));
    everywhere(TOWER, &cases, 211);
}

#[test]
fn rapier_restores_no_state() {
    let program = programs(include_str!("../../../examples/microns.sa")).remove(0);
    let settings = Settings {
        max_ticks: Some(50),
        ..Settings::new(Model::Rapier, 1)
    };
    assert!(!settings.model.has_state());
    assert!(made(&program, &settings, &mut Keeper::default()).is_ok());
    let mut watch = Keeper {
        begins_with: Some(vec![0; 1 << 16]),
        ..Keeper::default()
    };
    let made = made(&program, &settings, &mut watch);
    assert!(matches!(made, Err(RunError::State(_))));
}

#[test]
fn rate_and_shuffle_restore_their_state() {
    let mut cases = Vec::new();
    for model in [Model::Rate, Model::Shuffle] {
        cases.push(Settings {
            max_ticks: Some(5000),
            ..Settings::new(model, 1)
        });
    }
    everywhere(TOWER, &cases[..1], 997);
    everywhere(TOWER, &cases[1..], 7);
}

#[test]
fn messages_that_take_time_and_get_lost() {
    let settings = Settings {
        max_ticks: Some(5000),
        ..Settings::new(Model::Shuffle, 1)
    };
    for mut program in programs(TOWER) {
        program.scene.messages = Some(Messages {
            hop: 3,
            loss: Some(0.4),
        });
        assert!(resumed_everywhere(&program, &settings, 13) > 5);
    }
}

/// Messages take 3 ticks per hop, so an abort takes several ticks. There is a checkpoint at every
/// tick.
#[test]
fn aborted_attempts_and_their_pauses() {
    let text = "assembly tower {
        seed plate 1 x 1 { A at (0, 0) }
        phase grow timeout 7 ticks { A.up ->> T[1..3] }
            on timeout { release grow  wait 9 ticks  retry 3 }
    }";
    let settings = Settings {
        max_ticks: Some(500),
        ..Settings::new(Model::Shuffle, 1)
    };
    let mut program = programs(text).remove(0);
    program.scene.messages = Some(Messages { hop: 3, loss: None });
    let (record, _) = made(&program, &settings, &mut Keeper::default()).expect("a valid scene");
    assert!(record.aborts.len() > 1, "{record:?}");
    let first = &record.aborts[0];
    assert!(
        !first.releases.is_empty() && first.retried > Some(first.tick + 9),
        "{first:?}"
    );
    assert!(resumed_everywhere(&program, &settings, 1) > 60);

    program.scene.faults = Some(Faults {
        dead: Some(0.1),
        latch: Some(0.3),
    });
    let (record, _) = made(&program, &settings, &mut Keeper::default()).expect("a valid scene");
    assert!(!record.faults.is_empty(), "{record:?}");
    assert!(resumed_everywhere(&program, &settings, 1) > 60);
}

#[test]
fn fluids_suction_and_magnets_that_always_attract() {
    for text in [
        include_str!("../../../examples/suction_growth.sa"),
        include_str!("../../../examples/experiment_2.sa"),
        include_str!("../../../examples/microns.sa"),
    ] {
        let short = Settings {
            max_ticks: Some(90),
            ..rigid()
        };
        everywhere(text, &[short], 41);
    }
}

#[test]
fn an_aggregate_without_physics() {
    let text = include_str!("../../../examples/experiment_2.sa");
    let program = programs(text).remove(0);
    let settings = Settings {
        max_ticks: Some(200),
        ..Settings::new(Model::Shuffle, 1)
    };
    assert!(resumed_everywhere(&program, &settings, 3) > 0);
}

#[test]
fn invalid_states_are_rejected() {
    let program = programs(TOWER).remove(0);
    let mut keeper = Keeper {
        every: 100,
        last: Some(250),
        ..Keeper::default()
    };
    assert!(matches!(
        made(&program, &rigid(), &mut keeper),
        Err(RunError::Cancelled)
    ));
    let (_, state) = keeper.saved.pop().expect("a checkpoint at tick 200");
    let mut longer = state.clone();
    longer[7] = 0x7f;
    for corrupted in [&state[..state.len() / 2], &[], &longer] {
        let mut watch = Keeper {
            begins_with: Some(corrupted.to_vec()),
            ..Keeper::default()
        };
        let made = made(&program, &rigid(), &mut watch);
        assert!(matches!(made, Err(RunError::State(_))));
    }
}
