//! Tests the events that an observer of a run receives.
use std::ops::ControlFlow;

use stochc::ir::record::{BondRecord, RunRecord};
use stochc::ir::table::PhaseId;
use stochc::runtime::observe::{ObservedEvent, Observer};
use stochc::runtime::world::{Body, FreeBond, SpatialWorld};
use stochc::runtime::{Model, RunError, Settings, observe, run};

/// Observer that stores all events of a run.
#[derive(Default)]
struct Notes {
    ticks: Vec<u64>,
    events: Vec<(u64, ObservedEvent)>,
    /// For every capture, the distance between the block and the cell that the event names.
    misplaced: Vec<f64>,
}

impl Observer for Notes {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        let tick = arena.tick();
        self.ticks.push(tick);
        for &event in events {
            self.events.push((tick, event));
            if let ObservedEvent::Captured { body, cell, .. } = event {
                let place = arena.state(body).position;
                self.misplaced.push((place - arena.centre(cell)).norm());
            }
        }
    }
}

fn observed(file: &str, model: Model) -> (RunRecord, RunRecord, Notes) {
    let program = stochc::check(file).programs.remove(0);
    let (tables, scene) = (program.tables.unwrap(), program.scene.unwrap());
    // An observer is called at the end of a tick, so it misses blocks that enter and leave within
    // it.
    let settings = Settings::new(model, 1);
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    let mut notes = Notes::default();
    let alone = run(&tables, &scene, &settings, 5, 3, &mut watch).unwrap();
    let seen = observe(&tables, &scene, &settings, 5, 3, &mut watch, &mut notes).unwrap();
    (alone, seen, notes)
}

#[test]
fn observing_does_not_change_a_run() {
    let dense = "tests/fixtures/dense.sa";
    // With an observer, every hop of a report is an event. Otherwise, reports may reach the plate
    // at once.
    for (file, model) in [
        (dense, Model::Rapier),
        (dense, Model::Rigid),
        ("examples/five_tower_reconfigured.sa", Model::Rigid),
        ("examples/closed_platform.sa", Model::Rigid),
    ] {
        let (alone, seen, notes) = observed(file, model);
        assert_eq!(alone, seen, "{file}");
        assert_eq!(notes.ticks, (0..=alone.ticks).collect::<Vec<_>>());
    }
}

#[test]
fn events_agree_with_the_record() {
    let (record, _, notes) = observed("examples/five_tower_reconfigured.sa", Model::Rigid);
    let count = |requested: fn(&ObservedEvent) -> bool| {
        notes
            .events
            .iter()
            .filter(|(_, event)| requested(event))
            .count()
    };
    assert_eq!(
        count(|event| matches!(event, ObservedEvent::Sent { .. })) as u64,
        record.hops
    );
    assert_eq!(
        count(|event| matches!(event, ObservedEvent::Phase(_))),
        record.phase_ticks.len()
    );
    assert!(count(|event| matches!(event, ObservedEvent::Released { .. })) > 0);
    let captures: Vec<_> = (notes.events.iter())
        .filter_map(|&(tick, event)| match event {
            ObservedEvent::Captured {
                body,
                role,
                face,
                cell,
                ..
            } => Some((tick, body, role, face, cell)),
            _ => None,
        })
        .collect();
    let bonds: Vec<_> = (record.bonds.iter())
        .map(|bond| (bond.docked, bond.body, bond.child, bond.face, bond.cell))
        .collect();
    assert_eq!(captures, bonds);
    assert!(
        notes.misplaced.iter().all(|far| *far < 1e-6),
        "{:?}",
        notes.misplaced
    );
    // An observer misses entries into the field of a face in the field's last tick.
    let [mut seen, mut counted] = [0, 0];
    for bond in &record.bonds {
        let entries = entries(&notes, bond);
        assert!(entries <= bond.entries, "{entries} {bond:?}");
        seen += entries;
        counted += bond.entries;
    }
    assert!(10 * seen > 8 * counted, "{seen} of {counted}");
}

/// Returns the number of entries into the field of a face, while it was on and before its capture.
fn entries(notes: &Notes, bond: &BondRecord) -> u32 {
    let mut open = None;
    let mut entries = 0;
    for (tick, event) in &notes.events {
        match *event {
            ObservedEvent::Magnetized {
                body, child, face, ..
            } if (*tick, child, face) == (bond.magnetized, bond.child, bond.face) => {
                open = Some((body, face));
                entries = 0;
            }
            ObservedEvent::Entered { of, face, .. } if open == Some((of, face)) => entries += 1,
            ObservedEvent::Captured { body, on, face, .. }
                if (*tick, body) == (bond.docked, bond.body) && open == Some((on, face)) =>
            {
                return entries;
            }
            _ => {}
        }
    }
    panic!("the capture has not been seen");
}

#[test]
fn every_exit_has_an_entry() {
    let (_, _, notes) = observed("tests/fixtures/dense.sa", Model::Rigid);
    let mut inside: Vec<(u32, Body)> = Vec::new();
    let mut left = 0;
    for (_, event) in &notes.events {
        match *event {
            ObservedEvent::Entered { body, of, .. } => {
                assert!(!inside.contains(&(body, of)));
                inside.push((body, of));
            }
            ObservedEvent::Left { body, of, .. } => {
                left += 1;
                let at = inside.iter().position(|pair| *pair == (body, of));
                inside.remove(at.expect("the block had entered"));
            }
            ObservedEvent::Captured { body, .. } => inside.retain(|(id, _)| *id != body),
            _ => {}
        }
    }
    assert!(left > 0, "the test needs a block that leaves");
}

#[test]
fn a_model_without_positions_has_no_observer() {
    let program = stochc::check("tests/fixtures/dense.sa").programs.remove(0);
    let (tables, scene) = (program.tables.unwrap(), program.scene.unwrap());
    let settings = Settings {
        model: Model::Shuffle,
        ..Settings::default()
    };
    let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
    let mut notes = Notes::default();
    let refused = observe(&tables, &scene, &settings, 1, 0, &mut watch, &mut notes);
    assert_eq!(refused, Err(RunError::Nowhere(Model::Shuffle)));
}

/// Observer that compares bond events of free blocks with the groups of the world at every tick.
#[derive(Default)]
struct Groups {
    bonds: Vec<FreeBond>,
    bonded: usize,
    unbonded: usize,
}

impl Observer for Groups {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        let groups = arena.groups();
        let size = |id: u32| {
            let group = groups.iter().find(|group| group.contains(&id));
            group.map_or(1, |group| group.len() as u32)
        };
        for event in events {
            match *event {
                ObservedEvent::Bonded {
                    bond,
                    size: recorded,
                } => {
                    assert!(!self.bonds.contains(&bond));
                    assert_eq!(bond.bodies.map(size), [recorded; 2]);
                    self.bonds.push(bond);
                    self.bonded += 1;
                }
                ObservedEvent::Unbonded { bond, sizes } => {
                    assert_eq!(bond.bodies.map(size), sizes);
                    let at = self.bonds.iter().position(|known| *known == bond);
                    self.bonds.remove(at.expect("it had bonded by these faces"));
                    self.unbonded += 1;
                }
                ObservedEvent::Captured { body, .. } => assert_eq!(size(body), 1),
                _ => {}
            }
        }
        // The bonds of each group form a tree, and no bond connects two groups.
        let mut known: Vec<Vec<u32>> = Vec::new();
        for FreeBond { bodies, .. } in &self.bonds {
            assert!(bodies[0] < bodies[1]);
            let mut whole = Vec::new();
            for id in bodies {
                let at = known.iter().position(|group| group.contains(id));
                whole.extend(at.map_or_else(|| vec![*id], |at| known.remove(at)));
            }
            whole.sort_unstable();
            assert!(
                whole.is_sorted_by(|a, b| a < b),
                "{bodies:?} were bonded before"
            );
            known.push(whole);
        }
        known.sort_unstable();
        assert_eq!(known, groups, "at {}", arena.tick());
        // The bonded faces point to the centre of the other block.
        for FreeBond { bodies, faces } in &self.bonds {
            let [first, second] = bodies.map(|id| arena.state(id));
            let between = second.position - first.position;
            for (state, displacement, face) in
                [(first, between, faces[0]), (second, -between, faces[1])]
            {
                let own = state.orientation.inverse() * displacement;
                let along: f64 = (own.iter().zip(face.normal()))
                    .map(|(part, normal)| part * f64::from(normal))
                    .sum();
                assert!(
                    along > 0.9 * displacement.norm(),
                    "{bodies:?} {faces:?}: {own}"
                );
            }
        }
    }
}

#[test]
fn bonds_of_free_blocks_match_the_groups() {
    for model in [Model::Rapier, Model::Rigid] {
        for file in ["tests/fixtures/swarm.sa", "tests/fixtures/jets.sa"] {
            let program = stochc::check(file).programs.remove(0);
            let (tables, scene) = (program.tables.unwrap(), program.scene.unwrap());
            let settings = Settings {
                max_ticks: Some(4000),
                ..Settings::new(model, 2)
            };
            let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
            let mut groups = Groups::default();
            let alone = run(&tables, &scene, &settings, 1, 0, &mut watch).unwrap();
            let seen = observe(&tables, &scene, &settings, 1, 0, &mut watch, &mut groups).unwrap();
            assert_eq!(alone, seen);
            let Groups {
                bonded, unbonded, ..
            } = groups;
            assert!(
                bonded > 2 && unbonded > 0,
                "{file} {model:?}: {bonded}, {unbonded}"
            );
        }
    }
}
