//! What is seen of a run that is asked how it stands, held against what an observer of it has been told.
use std::collections::BTreeSet;
use std::ops::ControlFlow;

use stochc::ir::Face;
use stochc::ir::table::{PhaseId, RoleId};
use stochc::runtime::observe::{ObservedEvent, Observer};
use stochc::runtime::view::RunView;
use stochc::runtime::world::{Arena, Body};
use stochc::runtime::{Model, Settings, Watch, observe, run};

/// Asks for a view every so many ticks.
struct Curious {
    every: u64,
    tick: u64,
    seen: Vec<RunView>,
}

impl Watch for Curious {
    fn tick(&mut self, tick: u64, _phase: PhaseId) -> ControlFlow<()> {
        self.tick = tick;
        ControlFlow::Continue(())
    }

    fn wants_view(&mut self) -> bool {
        self.tick.is_multiple_of(self.every)
    }

    fn view(&mut self, make: &dyn Fn() -> RunView) {
        self.seen.push(make());
    }
}

/// The structure, from events, at the ticks at which views are asked for.
struct Told {
    every: u64,
    phase: PhaseId,
    held: BTreeSet<(u32, RoleId, PhaseId)>,
    active: BTreeSet<(Body, Face)>,
    in_reach: BTreeSet<(u32, Body, Face)>,
    told: Vec<State>,
}

type State = (
    u64,
    PhaseId,
    BTreeSet<(u32, RoleId, PhaseId)>,
    BTreeSet<(Body, Face)>,
    BTreeSet<(u32, Body, Face)>,
);

impl Observer for Told {
    fn look(&mut self, arena: &impl Arena, events: &[ObservedEvent]) {
        for &event in events {
            match event {
                ObservedEvent::Phase(phase) => self.phase = phase,
                ObservedEvent::Magnetized { body, face, .. } => {
                    self.active.insert((body, face));
                }
                ObservedEvent::Entered { body, of, face } => {
                    self.in_reach.insert((body, of, face));
                }
                ObservedEvent::Left { body, of, face } => {
                    self.in_reach.remove(&(body, of, face));
                }
                ObservedEvent::Captured {
                    body,
                    on,
                    face,
                    role,
                    ..
                } => {
                    self.active.remove(&(on, face));
                    self.in_reach.retain(|(it, ..)| *it != body);
                    self.held.insert((body, role, self.phase));
                }
                ObservedEvent::Released { body, .. } => {
                    self.held.retain(|(it, ..)| *it != body);
                    self.active.retain(|(of, _)| *of != Body::Free(body));
                }
                _ => {}
            }
        }
        let tick = arena.tick();
        if tick.is_multiple_of(self.every) {
            let (held, active) = (self.held.clone(), self.active.clone());
            (self.told).push((tick, self.phase, held, active, self.in_reach.clone()));
        }
    }
}

fn state(view: &RunView) -> State {
    let arena = view.arena.as_ref().expect("the model has places");
    let held = view.held.iter();
    (
        view.tick,
        view.phase,
        held.map(|it| (it.body, it.role, it.phase)).collect(),
        arena.active.iter().copied().collect(),
        arena.in_reach.iter().copied().collect(),
    )
}

#[test]
fn a_view_is_what_the_events_have_led_to_and_changes_nothing() {
    for (model, file, every, most) in [
        (Model::Rapier, "tests/fixtures/dense.sa", 1, 1),
        (Model::Rigid, "examples/five_tower_reconfigured.sa", 20, 4),
    ] {
        let mut checked = stochc::check(file);
        let program = checked.programs.remove(0);
        let (tables, scene) = (program.tables.unwrap(), program.scene.unwrap());
        let settings = Settings {
            max_ticks: Some(20_000),
            ..Settings::of(model, 1)
        };
        let mut alone = |_: u64, _: PhaseId| ControlFlow::Continue(());
        let record = run(&tables, &scene, &settings, 5, 3, &mut alone).unwrap();
        let mut curious = Curious {
            every,
            tick: 0,
            seen: Vec::new(),
        };
        let mut told = Told {
            every,
            phase: PhaseId(0),
            held: BTreeSet::new(),
            active: BTreeSet::new(),
            in_reach: BTreeSet::new(),
            told: Vec::new(),
        };
        let seen = observe(&tables, &scene, &settings, 5, 3, &mut curious, &mut told).unwrap();
        assert_eq!(seen, record);
        // Of the last tick nobody asks.
        told.told.truncate(curious.seen.len());
        assert!(curious.seen.len() as u64 >= record.ticks / every);
        let views: Vec<State> = curious.seen.iter().map(state).collect();
        assert_eq!(views, told.told);
        let held = views.iter().map(|(_, _, held, ..)| held.len());
        assert!(held.clone().max() >= Some(most), "{file}: {:?}", held.max());
        assert!(views.iter().any(|(.., in_reach)| !in_reach.is_empty()));
        for view in &curious.seen {
            let arena = view.arena.as_ref().unwrap();
            assert_eq!(arena.poses.len(), scene.free.count as usize);
            for held in &view.held {
                // The middle of the plate is the origin of x and y.
                let [x, y, z, ..] = arena.poses[held.body as usize];
                let (width, depth) = (tables.plate.width, tables.plate.depth);
                let place = [
                    f64::from(held.cell.x) - f64::from(width - 1) / 2.0,
                    f64::from(held.cell.y) - f64::from(depth - 1) / 2.0,
                    f64::from(held.cell.z) - 0.5,
                ];
                for (is, should) in [x, y, z].into_iter().zip(place) {
                    assert!(
                        (f64::from(is) - should).abs() < 0.2,
                        "{held:?}: {is} {should}"
                    );
                }
            }
        }
    }
}

#[test]
fn without_places_there_is_the_structure_alone() {
    let mut checked = stochc::check("tests/fixtures/tower.sa");
    let program = checked.programs.remove(0);
    let (tables, scene) = (program.tables.unwrap(), program.scene.unwrap());
    let mut curious = Curious {
        every: 1,
        tick: 0,
        seen: Vec::new(),
    };
    let settings = Settings::of(Model::Shuffle, 1);
    run(&tables, &scene, &settings, 5, 3, &mut curious).unwrap();
    assert!(curious.seen.iter().all(|view| view.arena.is_none()));
    let last = curious.seen.last().unwrap();
    assert_eq!(last.held.len(), 2);
}
