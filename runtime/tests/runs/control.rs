//! Runs tables in a world that captures in random order with random orientations. Checks that the
//! blocks build the structure of the tables at the right times.

use std::ops::ControlFlow;

use crate::scenes::{at, dockings, in_steps, reject};
use crate::tables::{Draft, at_once, chain, magnetize};
use proptest::prelude::*;
use stochc_ir::record::{BondRecord, Limit, Origin, Outcome, RunRecord};
use stochc_ir::scene::{BondKind, Messages};
use stochc_ir::table::{Action, Condition, Notification, PhaseId, RoleId, Tables};
use stochc_ir::{Cell, Face};
use stochc_runtime::control::Controller;
use stochc_runtime::world::shuffle::ShuffleWorld;
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};
use stochc_runtime::{RunError, drive};

in_every_world!(a_seed_that_captures_nothing_attracts_as_well);

fn proceed(_: u64, _: PhaseId) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Returns the record of a run without physics, and its final world.
fn shuffle(tables: &Tables, hop: Option<u32>, run: u64) -> (RunRecord, ShuffleWorld) {
    let mut world = ShuffleWorld::new(tables, 30, 5, run);
    let messages = hop.map(|hop| Messages { hop, loss: None });
    let record = drive(
        tables,
        messages.as_ref(),
        &mut world,
        Some(1000),
        5,
        run,
        &mut proceed,
    );
    (record.expect("the run is not cancelled"), world)
}

fn bond(record: &RunRecord, child: RoleId) -> &BondRecord {
    let found = record.bonds.iter().find(|bond| bond.child == child);
    found.expect("the role was assigned")
}

const SNAKE: [Face; 8] = [
    Face::Up,
    Face::Up,
    Face::East,
    Face::North,
    Face::Up,
    Face::West,
    Face::West,
    Face::South,
];

#[test]
fn a_chain_grows_with_any_orientation_of_blocks() {
    let (tables, roles) = chain(&SNAKE);
    for run in 0..200 {
        let (record, world) = shuffle(&tables, None, run);
        assert_eq!(record.outcome, Outcome::Completed);
        assert_eq!(record.bonds.len(), SNAKE.len());
        for (bond, &(role, cell)) in record.bonds.iter().zip(&roles[1..]) {
            assert_eq!((bond.child, bond.cell), (role, cell));
            assert_eq!(world.cells().get(&cell), Some(&bond.body));
        }
        assert_eq!(world.cells().len(), SNAKE.len());
        // The only report takes every step of the chain except the seed's own.
        assert_eq!(record.hops, SNAKE.len() as u64);
    }
}

proptest! {
    #[test]
    fn a_block_knows_its_orientation(run: u64) {
        let (tables, roles) = chain(&SNAKE);
        let mut world = ShuffleWorld::new(&tables, 9, 1, run);
        let mut controller = Controller::new(&tables, None, 1, run);
        let mut dockings = Vec::new();
        controller.start(&mut world);
        while controller.phase().is_some() {
            dockings.clear();
            world.step(&mut dockings).expect("no physics, no fault");
            controller.advance(&dockings, &mut world);
        }
        prop_assert_eq!(controller.structure().count(), roles.len());
        for (role, body, orientation) in controller.structure() {
            prop_assert_eq!(Some(orientation), world.orientation(body));
            prop_assert_eq!(controller.cell(role), Some(roles[role.0 as usize].1));
        }
    }
}

#[test]
fn a_waiting_capture_starts_after_the_earlier_docking() {
    let mut draft = Draft::default();
    let phase = draft.phase(3);
    let a = draft.seed("A", 1, 1);
    let hub = draft.role("hub");
    let arms = [Face::East, Face::North, Face::Up].map(|face| (face, draft.role(face.word())));
    let middle = Cell::new(1, 1, 1);
    draft.start(a, phase, vec![at_once(magnetize(Face::Up, hub, middle))]);
    let mut before = None;
    let rules = arms.iter().map(|&(face, arm)| {
        let when = before.replace(Condition::Docked(arm)).into_iter().collect();
        let cell = middle.across(face).expect("a neighbouring cell");
        (when, magnetize(face, arm, cell))
    });
    draft.anchored(hub, phase, rules.collect());
    for (_, arm) in arms {
        draft.anchored(arm, phase, vec![at_once(Action::Report)]);
    }
    let tables = draft.tables();
    for run in 0..50 {
        let (record, _) = shuffle(&tables, None, run);
        assert_eq!(record.outcome, Outcome::Completed);
        for pair in record.bonds.windows(2) {
            assert_eq!(pair[1].magnetized, pair[0].docked);
        }
        assert_eq!(record.hops, 2 * 3);
    }
}

/// A and B capture two blocks each. In a second phase A's are released, children first, and
/// captured again.
fn release(hop: Option<u32>) -> (RunRecord, ShuffleWorld, [RoleId; 4]) {
    let mut draft = Draft::default();
    let (grow, shrink, again) = (draft.phase(1), draft.phase(1), draft.phase(1));
    let a = draft.seed("A", 0, 0);
    let [b, c, d] = ["B", "C", "D"].map(|name| draft.role(name));
    let cell = |z| Cell::new(0, 0, z);
    draft.start(a, grow, vec![at_once(magnetize(Face::Up, b, cell(1)))]);
    draft.anchored(b, grow, vec![at_once(magnetize(Face::Up, c, cell(2)))]);
    draft.anchored(c, grow, vec![at_once(Action::Report)]);
    let off = |child| Action::SwitchOff {
        face: Face::Up,
        child,
    };
    draft.start(c, shrink, vec![at_once(Action::AskRelease)]);
    draft.start(
        b,
        shrink,
        vec![
            (vec![Condition::Asked(c)], off(c)),
            (vec![Condition::Released(c)], Action::AskRelease),
        ],
    );
    draft.start(
        a,
        shrink,
        vec![
            (vec![Condition::Asked(b)], off(b)),
            (vec![Condition::Released(b)], Action::Report),
        ],
    );
    draft.start(a, again, vec![at_once(magnetize(Face::Up, d, cell(1)))]);
    draft.anchored(d, again, vec![at_once(Action::Report)]);
    let tables = draft.tables();
    let mut world = ShuffleWorld::new(&tables, 2, 5, 3);
    let messages = hop.map(|hop| Messages { hop, loss: None });
    let record = drive(
        &tables,
        messages.as_ref(),
        &mut world,
        Some(99),
        5,
        3,
        &mut proceed,
    );
    (
        record.expect("the run is not cancelled"),
        world,
        [a, b, c, d],
    )
}

#[test]
fn a_release_is_requested_and_frees_children_first() {
    let (record, world, [_, b, c, d]) = release(Some(5));
    assert_eq!(record.outcome, Outcome::Completed);
    // C reports over two hops. Then C asks B, and B asks A. D reports over one hop.
    assert_eq!(record.hops, 2 + 1 + 1 + 1);
    assert_eq!(record.phase_ticks, [2 + 2 * 5, 2 * 5, 1 + 5]);
    let again = bond(&record, d);
    let start = record.phase_ticks[0];
    let (role, tick) = if again.body == bond(&record, c).body {
        (c, start + 5)
    } else {
        (b, start + 10)
    };
    assert_eq!(again.origin, Origin::Released { role, tick });
    assert_eq!(bond(&record, b).origin, Origin::Free);
    assert_eq!(record.blocks_used, 2);
    assert_eq!(world.cells().len(), 1);
}

#[test]
fn without_delay_messages_arrive_in_the_same_tick() {
    let (record, _, _) = release(None);
    assert_eq!(record.phase_ticks, [2, 0, 1]);
    assert_eq!(record.ticks, 3);
    assert_eq!(record.hops, 5);
}

/// Returns a run with towers of two on A and B. M captures N only after both are complete. N's
/// child O also waits for a message that can arrive before N has docked.
fn notification(hop: Option<u32>, run: u64) -> (RunRecord, [RoleId; 4]) {
    let mut draft = Draft::default();
    let phase = draft.phase(1);
    let [a, b] = [draft.seed("A", 0, 0), draft.seed("B", 2, 2)];
    let m = draft.seed("M", 1, 1);
    let [e, f, i, j, n, o] = ["E", "F", "I", "J", "N", "O"].map(|name| draft.role(name));
    let notified = |role| Condition::Notified(Notification::Anchored(role));
    let notify = |to, role| {
        at_once(Action::Notify {
            to,
            notification: Notification::Anchored(role),
        })
    };
    for (seed, x, low, high) in [(a, 0, e, i), (b, 2, f, j)] {
        let cell = |z| Cell::new(x, x, z);
        draft.start(
            seed,
            phase,
            vec![at_once(magnetize(Face::Up, low, cell(1)))],
        );
        draft.anchored(
            low,
            phase,
            vec![at_once(magnetize(Face::Up, high, cell(2)))],
        );
        draft.anchored(high, phase, vec![notify(m, high), notify(n, high)]);
    }
    let first = magnetize(Face::Up, n, Cell::new(1, 1, 1));
    draft.start(m, phase, vec![(vec![notified(i)], first)]);
    let second = magnetize(Face::Up, o, Cell::new(1, 1, 2));
    draft.anchored(n, phase, vec![(vec![notified(i), notified(j)], second)]);
    draft.anchored(o, phase, vec![at_once(Action::Report)]);
    (shuffle(&draft.tables(), hop, run).0, [i, j, n, o])
}

#[test]
fn notifications_cross_the_plate_and_wait_for_their_receiver() {
    for run in 0..50 {
        let (record, [i, j, n, o]) = notification(Some(7), run);
        assert_eq!(record.outcome, Outcome::Completed);
        let docked = |role| bond(&record, role).docked;
        // The message goes down I's tower to the plate. M is part of the plate.
        assert_eq!(bond(&record, n).magnetized, docked(i) + 2 * 7);
        // The message reaches M and continues to N, which may dock later.
        let at_n = |notification: u64| (notification + 2 * 7).max(docked(n)) + 7;
        assert_eq!(
            bond(&record, o).magnetized,
            at_n(docked(i)).max(at_n(docked(j)))
        );
        // Two messages of two hops from each tower, two hops up to N, and two hops for the report.
        assert_eq!(record.hops, 4 * 2 + 2 + 2);
    }
}

#[test]
fn a_new_holder_knows_the_messages_of_the_last() {
    // In the second phase X is released after C has docked, and B captures a new X. The new X
    // captures Y after C has docked. Only the old X received the message that C has docked.
    let mut draft = Draft::default();
    let (first, second) = (draft.phase(1), draft.phase(1));
    let [a, b, d] = [("A", 0), ("B", 1), ("D", 2)].map(|(name, x)| draft.seed(name, x, 0));
    let [x, y, c] = ["X", "Y", "C"].map(|name| draft.role(name));
    let cell = |x, z| Cell::new(x, 0, z);
    let face = Face::Up;
    draft.start(a, first, vec![at_once(magnetize(face, x, cell(0, 1)))]);
    draft.anchored(x, first, vec![at_once(Action::Report)]);
    let notification = Notification::Anchored(c);
    draft.start(d, second, vec![at_once(magnetize(face, c, cell(2, 1)))]);
    draft.anchored(
        c,
        second,
        vec![at_once(Action::Notify {
            to: x,
            notification,
        })],
    );
    draft.start(
        x,
        second,
        vec![(vec![Condition::Notified(notification)], Action::AskRelease)],
    );
    let released = Notification::Released(x);
    draft.start(
        a,
        second,
        vec![
            (
                vec![Condition::Asked(x)],
                Action::SwitchOff { face, child: x },
            ),
            (
                vec![Condition::Released(x)],
                Action::Notify {
                    to: b,
                    notification: released,
                },
            ),
        ],
    );
    let again = magnetize(face, x, cell(1, 1));
    draft.start(
        b,
        second,
        vec![(vec![Condition::Notified(released)], again)],
    );
    let next = magnetize(face, y, cell(1, 2));
    draft.anchored(
        x,
        second,
        vec![(vec![Condition::Notified(notification)], next)],
    );
    draft.anchored(y, second, vec![at_once(Action::Report)]);
    let tables = draft.tables();
    for hop in [None, Some(0), Some(3)] {
        let (record, _) = shuffle(&tables, hop, 1);
        assert_eq!(record.outcome, Outcome::Completed);
        assert_eq!(record.bonds.len(), 4);
    }
}

#[test]
fn a_phase_begins_when_the_last_report_arrives_and_an_empty_one_ends_at_once() {
    let mut draft = Draft::default();
    let (first, empty, second) = (draft.phase(1), draft.phase(0), draft.phase(1));
    let a = draft.seed("A", 1, 1);
    let [b, c] = ["B", "C"].map(|name| draft.role(name));
    let cell = |z| Cell::new(1, 1, z);
    draft.start(a, first, vec![at_once(magnetize(Face::Up, b, cell(1)))]);
    draft.anchored(b, first, vec![at_once(Action::Report)]);
    draft.start(b, second, vec![at_once(magnetize(Face::Up, c, cell(2)))]);
    draft.anchored(c, second, vec![at_once(Action::Report)]);
    let tables = draft.tables();
    let (record, _) = shuffle(&tables, Some(4), 0);
    assert_eq!(bond(&record, c).magnetized, bond(&record, b).docked + 4);
    assert_eq!(record.phase_ticks, [1 + 4, 0, 1 + 2 * 4]);
    assert_eq!(record.phase_ticks[empty.0 as usize], 0);
    assert_eq!(record.ticks, record.phase_ticks.iter().sum::<u64>());
}

#[test]
fn no_block_docks_into_an_occupied_cell() {
    // The towers on both sides of the middle compete for the cell above it. One of them never
    // docks.
    let mut draft = Draft::default();
    let phase = draft.phase(2);
    let [a, b] = [draft.seed("A", 0, 1), draft.seed("B", 2, 1)];
    for (seed, x, face) in [(a, 0, Face::East), (b, 2, Face::West)] {
        let [low, side] = [draft.role("low"), draft.role("side")];
        let cell = Cell::new(x, 1, 1);
        draft.start(seed, phase, vec![at_once(magnetize(Face::Up, low, cell))]);
        let middle = Cell::new(1, 1, 1);
        draft.anchored(low, phase, vec![at_once(magnetize(face, side, middle))]);
        draft.anchored(side, phase, vec![at_once(Action::Report)]);
    }
    draft.timeout(phase, 60);
    let (record, world) = shuffle(&draft.tables(), None, 0);
    let by = Limit::Timeout;
    assert_eq!(record.outcome, Outcome::TimedOut { phase, by });
    assert_eq!(record.ticks, 60);
    assert_eq!((record.bonds.len(), world.cells().len()), (3, 3));
    // Its wait is the only one that has not ended. It began when its own block docked.
    let [wait] = &record.waiting[..] else {
        panic!("{:?}", record.waiting)
    };
    let parent = record.bonds.iter().find(|bond| bond.child == wait.parent);
    assert_eq!(
        wait.magnetized,
        parent.expect("the block has docked").docked
    );
    assert_eq!((wait.phase, wait.cell), (phase, Cell::new(1, 1, 1)));
    assert!(record.bonds.iter().all(|bond| bond.child != wait.child));
}

#[test]
fn a_run_ends_at_its_limit_or_when_it_is_cancelled() {
    let (tables, _) = chain(&SNAKE);
    let mut world = ShuffleWorld::new(&tables, 3, 0, 0);
    let record = drive(&tables, None, &mut world, Some(40), 0, 0, &mut proceed)
        .expect("the run is not cancelled");
    let (phase, by) = (PhaseId(0), Limit::MaxTicks);
    assert_eq!(record.outcome, Outcome::TimedOut { phase, by });
    assert_eq!((record.ticks, record.blocks_used), (40, 3));
    let mut world = ShuffleWorld::new(&tables, 30, 0, 0);
    let mut stop = |tick, _| {
        if tick < 3 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    let cancelled = drive(&tables, None, &mut world, None, 0, 0, &mut stop);
    assert_eq!(cancelled, Err(RunError::Cancelled));
    assert_eq!(world.tick(), 3);
    assert!(world.orientation(Body::Seed(Cell::new(0, 0, 0))).is_some());
}

/// Returns the same tables for hardware whose faces always attract.
fn passive(mut tables: Tables) -> Tables {
    tables.bond = BondKind::Reject;
    tables
}

#[test]
fn an_unplanned_block_is_rejected_at_once() {
    let (tables, roles) = chain(&SNAKE);
    let tables = passive(tables);
    let mut all = 0;
    for run in 0..200 {
        let mut world = ShuffleWorld::new(&tables, 30, 5, run).with_strays(0.5);
        let record = drive(&tables, None, &mut world, Some(1000), 5, run, &mut proceed)
            .expect("the run is not cancelled");
        assert_eq!(record.outcome, Outcome::Completed);
        // The final structure equals the structure of the tables.
        assert_eq!(world.cells().len(), SNAKE.len());
        for (bond, &(role, cell)) in record.bonds.iter().zip(&roles[1..]) {
            assert_eq!((bond.child, bond.cell), (role, cell));
            assert_eq!(world.cells().get(&cell), Some(&bond.body));
        }
        assert_eq!(
            record.hops,
            SNAKE.len() as u64,
            "rejections cause no messages"
        );
        assert_eq!(record.unplanned_bonds.len() as u64, record.unplanned);
        for bond in &record.unplanned_bonds {
            let expected = record.bonds.iter().any(|planned| {
                (planned.docked, planned.body) == (bond.tick, bond.body)
                    && (planned.parent, planned.face) == (bond.parent, bond.face)
            });
            assert!(!expected && bond.tick <= record.ticks, "{bond:?}");
        }
        all += record.unplanned;
    }
    // Strays dock in half of the ticks, except in the first. Each run has at least eight ticks.
    assert!((500..1200).contains(&all), "{all}");
}

/// Returns tables with two seeds. Only the first seed ever captures.
fn idle_seed() -> (Tables, [RoleId; 2]) {
    let mut draft = Draft::default();
    let phase = draft.phase(1);
    let [p, q] = [("P", 0), ("Q", 2)].map(|(name, x)| draft.seed(name, x, 1));
    let a = draft.role("A");
    let rules = vec![at_once(magnetize(Face::Up, a, Cell::new(0, 1, 1)))];
    draft.start(p, phase, rules);
    draft.anchored(a, phase, vec![at_once(Action::Report)]);
    (passive(draft.tables()), [p, q])
}

#[test]
fn a_seed_that_captures_nothing_gets_strays_as_well() {
    let (tables, [p, q]) = idle_seed();
    let mut by = [0, 0];
    for run in 0..200 {
        let mut world = ShuffleWorld::new(&tables, 30, 5, run).with_strays(1.0);
        let record = drive(&tables, None, &mut world, Some(1), 5, run, &mut proceed)
            .expect("the run is not cancelled");
        by[0] += record
            .unplanned_bonds
            .iter()
            .filter(|bond| bond.parent == p)
            .count();
        by[1] += record
            .unplanned_bonds
            .iter()
            .filter(|bond| bond.parent == q)
            .count();
    }
    // The only stray of each run docks at the second seed. A docking at the first seed is expected.
    assert_eq!(by, [0, 200]);
}

/// The free block is midway between the two seeds.
fn a_seed_that_captures_nothing_attracts_as_well<W: SpatialWorld>() {
    let (tables, _) = idle_seed();
    let block = BodyState::at_rest(at(0.0, 0.0, 0.8));
    let mut world: W = in_steps(&reject(0.1, 0.0), &[block]);
    Controller::new(&tables, None, 5, 0).start(&mut world);
    let on: Vec<BlockFace> = world
        .active()
        .into_iter()
        .map(|(block_face, _)| block_face)
        .collect();
    let up = |x| BlockFace {
        body: Body::Seed(Cell::new(x, 1, 0)),
        face: Face::Up,
    };
    assert_eq!(on, [up(0), up(2)]);
    assert!(dockings(&mut world, 1).is_empty());
    let velocity = world.state(0).velocity;
    assert!(
        velocity.z < -1e-4 && velocity.x.abs() < 1e-3 * -velocity.z,
        "{velocity}"
    );
}

#[test]
fn a_stray_where_faces_are_switched_on_is_no_unplanned_bond() {
    let (tables, _) = chain(&SNAKE);
    let mut world = ShuffleWorld::new(&tables, 30, 5, 0).with_strays(0.5);
    let record = drive(&tables, None, &mut world, Some(1000), 5, 0, &mut proceed)
        .expect("the run is not cancelled");
    assert_eq!(record.outcome, Outcome::Completed);
    assert_eq!((record.unplanned, world.cells().len()), (0, SNAKE.len()));
}

/// Returns a chain whose first blocks are pre-attached, and the roles of all blocks.
fn pre_attached(count: usize) -> (Tables, Vec<(RoleId, Cell)>) {
    let mut draft = Draft::default();
    let (first, second) = (draft.phase(0), draft.phase(1));
    draft.plant(first);
    let mut cell = Cell::new(1, 1, 0);
    let mut roles = vec![(draft.seed("T0", 1, 1), cell)];
    for (i, &face) in SNAKE.iter().enumerate() {
        let (parent, child) = (roles[i].0, draft.role(&format!("T{}", i + 1)));
        cell = cell.across(face).expect("a short chain");
        let rules = vec![at_once(magnetize(face, child, cell))];
        match (i < count, i == 0 || i == count) {
            (true, true) => draft.start(parent, first, rules),
            (true, false) => draft.anchored(parent, first, rules),
            (false, true) => draft.start(parent, second, rules),
            (false, false) => draft.anchored(parent, second, rules),
        }
        roles.push((child, cell));
    }
    let last = roles[SNAKE.len()].0;
    draft.anchored(last, second, vec![at_once(Action::Report)]);
    (draft.tables(), roles)
}

#[test]
fn pre_attached_blocks_exist_at_tick_0() {
    let (tables, roles) = pre_attached(3);
    let mut world = ShuffleWorld::new(&tables, 9, 5, 1);
    let mut controller = Controller::new(&tables, None, 5, 1);
    controller.start(&mut world);
    assert_eq!(controller.phase(), Some(PhaseId(1)));
    assert_eq!((controller.phase_ticks(), world.tick()), (&[0][..], 0));
    // The free blocks with the highest numbers are attached in order, and none is turned.
    let cells: Vec<_> = world
        .cells()
        .iter()
        .map(|(&cell, &id)| (cell, id))
        .collect();
    let expected: Vec<_> = (1..=3).map(|i| (roles[i].1, 9 - i as u32)).collect();
    assert_eq!(cells.len(), 3);
    assert!(expected.iter().all(|one| cells.contains(one)), "{cells:?}");
    for (_, body, orientation) in controller.structure() {
        assert_eq!(Some(orientation), world.orientation(body));
    }
    for hop in [None, Some(3)] {
        let (record, world) = shuffle(&tables, hop, 1);
        assert_eq!(record.outcome, Outcome::Completed);
        assert_eq!((record.phase_ticks[0], record.phase_ticks.len()), (0, 2));
        assert_eq!(
            record.hops,
            SNAKE.len() as u64,
            "pre-attached blocks do not report"
        );
        assert_eq!(world.cells().len(), SNAKE.len());
    }
}

#[test]
fn without_a_block_to_attach_the_run_fails() {
    let (tables, _) = pre_attached(3);
    let mut world = ShuffleWorld::new(&tables, 2, 5, 1);
    let record = drive(&tables, None, &mut world, Some(1000), 5, 1, &mut proceed)
        .expect("the run is not cancelled");
    let reason = "no free block is left to pre-attach as T3".to_owned();
    let outcome = Outcome::Failed {
        phase: PhaseId(0),
        reason,
        is_broken: true,
    };
    assert_eq!(record.outcome, outcome);
    assert_eq!((record.ticks, record.phase_ticks.len()), (0, 0));
}

/// Returns the record of a chain that is built with lossy messages.
fn lossy(hop: u32, loss: f64, run: u64) -> RunRecord {
    let (tables, _) = chain(&SNAKE);
    let mut world = ShuffleWorld::new(&tables, 30, 5, run);
    let loss = Some(loss);
    let messages = Messages { hop, loss };
    let record = drive(
        &tables,
        Some(&messages),
        &mut world,
        Some(5000),
        5,
        run,
        &mut proceed,
    );
    record.expect("the run is not cancelled")
}

#[test]
fn lost_messages_are_resent_and_cost_hops_and_time() {
    let (mut hops, mut ticks) = (0, 0);
    let (runs, hop, loss) = (400, 3, 0.3);
    for run in 0..runs {
        let record = lossy(hop, loss, run);
        assert_eq!(record.outcome, Outcome::Completed);
        assert_eq!(record.bonds.len(), SNAKE.len());
        hops += record.hops;
        ticks += record.ticks - SNAKE.len() as u64;
    }
    let sent = (runs * SNAKE.len() as u64) as f64;
    // A transfer is repeated until it arrives, 1 / 0.7 times on average. It is repeated until its
    // acknowledgement arrives, 1 / 0.7^2 times in total, unless the phase ends earlier.
    let hops = hops as f64 / sent;
    assert!(
        (1.0 / 0.7..1.0 / 0.49).contains(&hops),
        "{hops} hops per hop"
    );
    // A message continues when it has arrived, after 1 / 0.7 - 1 repetitions on average.
    // Repetitions are 2 hop + 1 ticks apart.
    let expected = sent * (3.0 + 7.0 * (1.0 / 0.7 - 1.0));
    let deviation = (expected - ticks as f64).abs() / expected;
    assert!(deviation < 0.05, "{ticks} ticks, {expected} expected");
}

#[test]
fn a_message_that_is_always_lost_ends_no_phase() {
    let record = lossy(0, 1.0, 0);
    let (phase, by) = (PhaseId(0), Limit::MaxTicks);
    assert_eq!(record.outcome, Outcome::TimedOut { phase, by });
    assert_eq!(record.bonds.len(), SNAKE.len());
    assert_eq!(record.waiting, [], "only its message is in transit");
}

#[test]
fn a_dead_block_prevents_the_end_of_a_phase() {
    let (tables, roles) = chain(&SNAKE);
    for (struck, (role, _)) in roles.iter().enumerate().take(SNAKE.len()).skip(1) {
        let mut world = ShuffleWorld::new(&tables, 9, 1, 0);
        let mut controller = Controller::new(&tables, None, 1, 0);
        let mut dockings = Vec::new();
        controller.start(&mut world);
        for _ in 0..100 {
            dockings.clear();
            world.step(&mut dockings).expect("no physics, no fault");
            controller.advance(&dockings, &mut world);
            let holder = controller.structure().find(|held| held.0 == *role);
            if let Some((_, body, _)) = holder {
                controller.kill(body);
            }
        }
        // The block switched its face on before it died, and does not notice the block that docks
        // there.
        assert_eq!(controller.phase(), Some(PhaseId(0)));
        assert_eq!(controller.structure().count(), struck + 1);
        assert_eq!(world.cells().len(), struck + 1);
    }
}
