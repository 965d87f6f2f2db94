//! Tests whole runs of the model `rigid`: they end, are reproducible, and report failures.

use std::ops::ControlFlow;

use crate::scenes::{attract, compliant, contact, empty, hemisphere, kicks, paper, pass, world};
use crate::tables::{Draft, at_once, chain, magnetize};
use nalgebra::Vector3;
use stochc_ir::record::{Limit, Origin, Outcome, ReleaseRecord, RunRecord};
use stochc_ir::scene::room::NoRoom;
use stochc_ir::scene::{Agitation, Bond, Scene};
use stochc_ir::table::{Action, Condition, PhaseId, RoleId, Tables};
use stochc_ir::{Cell, Face};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BlockFace, Body, BodyState, SceneError, SpatialWorld, World};
use stochc_runtime::{Model, RunError, Settings, drive, run};

/// Returns a small enclosure with many blocks, whose captures follow each other quickly.
fn crowd() -> Scene {
    let mut scene = paper();
    scene.free.count = 60;
    scene.enclosure = hemisphere(1.6, 25.0);
    scene
}

fn record(tables: &Tables, scene: &Scene, settings: &Settings, number: u64) -> RunRecord {
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    run(tables, scene, settings, 9, number, &mut watch).expect("a valid scene")
}

/// Returns tables for three phases. A captures B, and B captures C and releases it in the next
/// phase. B then captures D.
fn three_phases() -> Tables {
    let mut draft = Draft::default();
    let [grow, shrink, again] = [1, 1, 1].map(|reports| draft.phase(reports));
    let a = draft.seed("A", 1, 1);
    let [b, c, d] = ["B", "C", "D"].map(|name| draft.role(name));
    let cell = |z| Cell::new(1, 1, z);
    let (face, child) = (Face::Up, c);
    draft.start(a, grow, vec![at_once(magnetize(Face::Up, b, cell(1)))]);
    draft.anchored(b, grow, vec![at_once(magnetize(Face::Up, c, cell(2)))]);
    draft.anchored(c, grow, vec![at_once(Action::Report)]);
    draft.start(c, shrink, vec![at_once(Action::AskRelease)]);
    draft.start(
        b,
        shrink,
        vec![
            (vec![Condition::Asked(c)], Action::SwitchOff { face, child }),
            (vec![Condition::Released(c)], Action::Report),
        ],
    );
    draft.start(b, again, vec![at_once(magnetize(Face::Up, d, cell(2)))]);
    draft.anchored(d, again, vec![at_once(Action::Report)]);
    draft.tables()
}

#[test]
fn a_small_tower_grows() {
    let (tables, roles) = chain(&[Face::Up, Face::Up, Face::East]);
    let record = record(&tables, &crowd(), &Settings::new(Model::Rapier, 1), 0);
    assert_eq!(record.outcome, Outcome::Completed);
    assert_eq!(record.phase_ticks, [record.ticks]);
    for (bond, &(role, cell)) in record.bonds.iter().zip(&roles[1..]) {
        assert_eq!((bond.child, bond.cell), (role, cell));
        assert!(bond.magnetized + bond.docking <= bond.docked);
        assert!(bond.entries >= 1);
        assert_eq!(bond.origin, Origin::Free);
    }
    assert_eq!(record.bonds.len(), 3);
    assert_eq!(record.hops, 3);
}

#[test]
fn a_run_is_the_same_alone_in_sequence_and_on_any_thread() {
    let (tables, scene) = (three_phases(), crowd());
    let settings = Settings::new(Model::Rapier, 1);
    let sequence: Vec<RunRecord> = (0..4)
        .map(|number| record(&tables, &scene, &settings, number))
        .collect();
    assert!(sequence.iter().all(|r| r.outcome == Outcome::Completed));
    assert_ne!(sequence[0].ticks, sequence[1].ticks);
    std::thread::scope(|threads| {
        let (tables, scene, settings) = (&tables, &scene, &settings);
        let alone = [3, 1].map(|number| {
            let run = threads.spawn(move || record(tables, scene, settings, number));
            (number, run)
        });
        for (number, run) in alone {
            let alone = run.join().expect("a run never panics");
            assert_eq!(alone, sequence[number as usize]);
        }
    });
}

/// A run that is stopped at any tick equals the beginning of the whole run. All its recorded bonds
/// have docked, and all its recorded waits have begun.
#[test]
fn unfinished_waits_are_finished_by_the_longer_run() {
    // Two towers next to each other, so that two faces are on at once.
    let mut draft = Draft::default();
    let phase = draft.phase(2);
    for (name, x) in [("A", 0), ("B", 2)] {
        let seed = draft.seed(name, x, 1);
        let [low, high] = [draft.role("low"), draft.role("high")];
        let up = |child, z| magnetize(Face::Up, child, Cell::new(x, 1, z));
        draft.start(seed, phase, vec![at_once(up(low, 1))]);
        draft.anchored(low, phase, vec![at_once(up(high, 2))]);
        draft.anchored(high, phase, vec![at_once(Action::Report)]);
    }
    let (tables, scene) = (draft.tables(), crowd());
    for model in [Model::Rapier, Model::Rigid] {
        let mut settings = Settings::new(model, 1);
        let whole = record(&tables, &scene, &settings, 0);
        assert_eq!(whole.outcome, Outcome::Completed);
        assert_eq!((whole.bonds.len(), &whole.waiting[..]), (4, &[][..]));
        for part in 0..12 {
            let limit = whole.ticks * part / 12;
            settings.max_ticks = Some(limit);
            let stopped = record(&tables, &scene, &settings, 0);
            let by = Limit::MaxTicks;
            assert_eq!(stopped.outcome, Outcome::TimedOut { phase, by });
            let docked = whole.bonds.iter().filter(|bond| bond.docked <= limit);
            assert!(docked.eq(&stopped.bonds), "{limit}");
            let mut running: Vec<_> = (whole.bonds.iter())
                .filter(|bond| bond.magnetized <= limit && limit < bond.docked)
                .collect();
            running.sort_by_key(|bond| (bond.magnetized, bond.parent));
            assert_eq!(running.len(), stopped.waiting.len(), "{limit}");
            for (bond, wait) in running.into_iter().zip(&stopped.waiting) {
                let key = (bond.phase, bond.parent, bond.face, bond.child, bond.cell);
                assert_eq!(
                    (wait.phase, wait.parent, wait.face, wait.child, wait.cell),
                    key
                );
                assert_eq!(wait.magnetized, bond.magnetized);
                assert!(wait.entries <= bond.entries, "{wait:?} {bond:?}");
            }
        }
    }
}

#[test]
fn entries_of_an_unfinished_wait_are_counted() {
    counted::<RapierWorld>(Model::Rapier);
    counted::<RigidWorld>(Model::Rigid);
}

/// Checks the entries of a block above a magnetized face. It is within reach but too far to be
/// captured.
fn counted<W: SpatialWorld>(model: Model) {
    let (tables, _) = chain(&[Face::Up]);
    let mut scene = empty();
    scene.bond = attract(0.0, 0.05);
    let settings = Settings::new(model, 1);
    let near = [BodyState::at_rest(Vector3::new(0.0, 0.0, 0.8))];
    let mut world =
        W::with_blocks(&scene, &tables.plate, &settings, 9, 0, &near).expect("a valid scene");
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    let record = drive(&tables, None, &mut world, Some(1), 9, 0, &mut watch);
    let waiting = record.expect("the run is not cancelled").waiting;
    assert_eq!((waiting.len(), waiting[0].entries), (1, 1), "{model:?}");
}

#[test]
fn releases_are_recorded() {
    let (tables, scene) = (three_phases(), crowd());
    let record = record(&tables, &scene, &Settings::new(Model::Rigid, 1), 0);
    let captured = |child| {
        let found = record.bonds.iter().find(|bond| bond.child == child);
        found.expect("the block was captured")
    };
    let (b, c) = (RoleId(1), RoleId(2));
    let (phase, tick, body) = (PhaseId(1), record.phase_ticks[0], captured(c).body);
    let (parent, child) = (b, c);
    let expected = ReleaseRecord {
        phase,
        parent,
        child,
        tick,
        body,
    };
    assert_eq!(record.releases, [expected]);
}

#[test]
fn a_captured_block_sits_on_the_lattice_and_a_released_one_starts_from_rest() {
    let mut scene = empty();
    scene.bond = attract(0.03, 0.05);
    scene.contact = contact(0.0, 0.2);
    let start = BodyState {
        velocity: Vector3::new(0.0, 0.0, -0.01),
        spin: Vector3::new(0.0, 0.0, 0.01),
        ..BodyState::at_rest(Vector3::new(1.02, 1.0, 0.6))
    };
    let mut world: RapierWorld = world(&scene, &Settings::new(Model::Rapier, 1), &[start]);
    let (body, face) = (Body::Seed(Cell::new(2, 2, 0)), Face::Up);
    world.magnetize(BlockFace { body, face });
    let mut dockings = Vec::new();
    while dockings.is_empty() {
        world.step(&mut dockings).expect("the physics is stable");
        assert!(world.tick() < 200, "it never docks");
    }
    let docking = dockings[0];
    assert_eq!((docking.block_face.body, docking.child), (body, 0));
    assert_eq!((docking.child_face, docking.entries), (Face::Down, 1));
    let seated = world.state(0);
    assert_eq!(seated.position, world.centre(Cell::new(2, 2, 1)));
    let sits = world.anchored(0).expect("it is anchored");
    assert!(
        seated
            .orientation
            .angle_to(&stochc_runtime::world::rotation::quaternion(sits))
            < 1e-6
    );
    pass(&mut world, 20);
    assert_eq!(world.state(0), seated);
    world.switch_off(BlockFace { body, face });
    assert_eq!(world.anchored(0), None);
    pass(&mut world, 20);
    // No force acts on it. The engine separates it from the plate by at most its margin.
    assert!((world.state(0).position - seated.position).norm() < 0.05);
}

#[test]
fn the_closer_block_docks_and_none_docks_twice() {
    let mut scene = empty();
    scene.bond = attract(0.0, 0.6);
    let above = |x: f64, z: f64| BodyState::at_rest(Vector3::new(x, 0.0, z));
    let blocks = [above(-0.9, 0.75), above(-0.9, 0.7), above(0.45, 0.6)];
    let mut world: RapierWorld = world(&scene, &Settings::new(Model::Rapier, 1), &blocks);
    let block_face = |x| BlockFace {
        body: Body::Seed(Cell::new(x, 1, 0)),
        face: Face::Up,
    };
    for x in 0..3 {
        world.magnetize(block_face(x));
    }
    let mut dockings = Vec::new();
    world.step(&mut dockings).expect("the physics is stable");
    let pairs: Vec<_> = dockings.iter().map(|d| (d.block_face, d.child)).collect();
    // Blocks 0 and 1 are near face 0. Block 2 is within reach of faces 1 and 2.
    assert_eq!(pairs, [(block_face(0), 1), (block_face(1), 2)]);
    pass(&mut world, 5);
}

#[test]
fn broken_physics_fails_the_run() {
    let (tables, _) = chain(&[Face::Up]);
    let mut scene = crowd();
    scene.agitation = Some(Agitation::Kicks {
        speed: (1e30, 1e30),
    });
    let record = record(&tables, &scene, &Settings::new(Model::Rapier, 1), 0);
    let phase = PhaseId(0);
    assert!(record.outcome.is_invalid());
    let Outcome::Failed {
        phase: p, reason, ..
    } = record.outcome
    else {
        panic!("{:?}", record.outcome);
    };
    assert_eq!(p, phase);
    assert!(reason.starts_with("block 0: its speed is"), "{reason}");
    assert_eq!(record.ticks, 0);
}

#[test]
fn not_a_number_fails_at_its_block() {
    found_at_once::<RapierWorld>();
    found_at_once::<RigidWorld>();
}

fn found_at_once<W: SpatialWorld>() {
    let mut scene = empty();
    scene.agitation = kicks(0.001);
    scene.contact = contact(0.0, 0.2);
    let at = |x: f64| BodyState::at_rest(Vector3::new(x, 0.0, 5.0));
    let blocks = [at(0.0), at(1.05), at(2.1)];
    type Spoil = fn(&mut BodyState);
    let spoils: [Spoil; 4] = [
        |state| state.velocity.x = f64::NAN,
        |state| state.position.z = f64::NAN,
        |state| state.spin.y = f64::INFINITY,
        |state| state.velocity.y = 1e6,
    ];
    for corrupt in spoils {
        let mut world: W = world(&scene, &Settings::new(Model::Rapier, 1), &blocks);
        pass(&mut world, 3);
        let mut state = world.state(1);
        corrupt(&mut state);
        world.set_state(1, &state);
        let fault = world
            .step(&mut Vec::new())
            .expect_err("the state is invalid");
        assert_eq!(fault.body, 1);
    }
}

#[test]
fn a_scene_that_cannot_be_set_up_is_an_error_before_the_run() {
    let (tables, _) = chain(&[Face::Up]);
    let error = |scene: &Scene| {
        let mut watch = |_: u64, _: PhaseId| panic!("the run has begun");
        let result = run(
            &tables,
            scene,
            &Settings::new(Model::Rapier, 1),
            0,
            0,
            &mut watch,
        );
        let Err(RunError::Scene(error)) = result else {
            panic!("{result:?}");
        };
        error
    };
    let mut scene = paper();
    scene.free.count = 30_000;
    let SceneError::NoRoom(NoRoom::DoesNotFit { count, fits }) = error(&scene) else {
        panic!("30,000 cubes of 0.2 m in a hemisphere of 5 m");
    };
    assert!(count == 30_000 && (10_000..30_000).contains(&fits));
    scene.enclosure = None;
    assert_eq!(
        error(&scene),
        SceneError::NoRoom(NoRoom::NoEnclosure { count })
    );
    let mut scene = paper();
    scene.block.mass = 0.0;
    let message = error(&scene).to_string();
    assert!(message.starts_with("`block.mass` is 0"), "{message}");
    let mut scene = paper();
    scene.contact = compliant(25.0, 5.0, 0.2);
    assert_eq!(
        error(&scene).to_string(),
        "the model `rapier` does not support contact with a `stiffness`; use `--model rigid`"
    );
}

#[test]
fn blocks_start_evenly_spread_and_apart() {
    let scene = paper();
    let settings = Settings::new(Model::Rapier, 1);
    let world = RapierWorld::new(&scene, &crate::scenes::PLATE, &settings, 0, 0).expect("they fit");
    let at: Vec<_> = (0..world.count())
        .map(|id| world.state(id).position)
        .collect();
    assert_eq!(at.len(), 300);
    assert!(at.iter().all(|p| p.norm() <= 24.0 && p.z >= 1.0));
    let apart = |i: usize| {
        at[..i]
            .iter()
            .map(|p| (p - at[i]).norm())
            .fold(99.0, f64::min)
    };
    assert!((1..300).all(|i| apart(i) > 4.0));
    // Half of the volume of a hemisphere is below this height.
    let low = at.iter().filter(|p| p.z < 0.3473 * 25.0).count();
    assert!((120..180).contains(&low), "{low}");
}

#[test]
fn only_dimensionless_numbers_matter() {
    // The same scene with blocks of 12 um. All factors are powers of two, so results are equal to
    // the bit.
    let (length, mass, time) = (2f64.powi(-14), 2f64.powi(-40), 2f64.powi(-9));
    let (speed, force) = (length / time, mass * length / (time * time));
    let mut small = crowd();
    small.tick *= time;
    small.block.side *= length;
    small.block.mass *= mass;
    small.enclosure = hemisphere(1.6 * length, 25.0 * mass / (time * time));
    small.agitation = Some(Agitation::Kicks {
        speed: (0.0, 0.4 * speed),
    });
    let Some(Bond::Attract {
        pull,
        align: Some(align),
        anchor,
        ..
    }) = &mut small.bond
    else {
        panic!("the paper's magnet");
    };
    for reach in [pull, align] {
        reach.force *= force;
        reach.within *= length;
    }
    anchor.within *= length;
    let tables = three_phases();
    let settings = Settings::new(Model::Rapier, 1);
    assert_eq!(
        record(&tables, &small, &settings, 2),
        record(&tables, &crowd(), &settings, 2)
    );
}
