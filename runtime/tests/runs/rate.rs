//! Tests the rate model: its waits follow the calibrated rates, and skipping ticks changes nothing.
use std::ops::ControlFlow;

use stochc_compiler::{Limits, check};
use stochc_control::{BlockFace, Docking};
use stochc_estimate::{Coverage, FORMAT, HeadStart, HeldOut, Neighbourhood, Parameters, Rates};
use stochc_ir::Face;
use stochc_ir::record::{Origin, Outcome, RunRecord};
use stochc_ir::scene::Scene;
use stochc_ir::state::State;
use stochc_ir::table::Tables;
use stochc_runtime::world::rate::RateWorld;
use stochc_runtime::world::{Fault, World};
use stochc_runtime::{Model, RunError, Settings, drive, run};

/// Returns the tables and the scene of a program.
fn compiled(text: &str) -> (Tables, Scene) {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let checked = check("program.sa", &mut reader, Limits::default());
    let program = checked
        .programs
        .into_iter()
        .next()
        .expect("it has a program");
    let executable = program.into_executable().expect("the program is valid");
    (executable.tables, executable.scene)
}

fn rates_of(scene: &Scene) -> Rates {
    Rates {
        format: FORMAT,
        scene: scene.clone(),
        simulated: "by hand".to_owned(),
        seed: 0,
        captures: 0,
        parameters: Parameters::TYPICAL,
        covariance: vec![0.0; Parameters::COUNT * Parameters::COUNT],
        profile: vec![1.0],
        free: scene.free.count,
        head_starts: vec![HeadStart {
            squared_distance: 0,
            before: 0,
            probability: 1.0,
            ticks: 2.0,
            late: false,
        }],
        coverage: Coverage {
            highest: 10,
            least_open: 0.1,
            least_free: 0.5,
        },
        kinds: Vec::new(),
        held_out: None,
    }
}

fn records(text: &str, runs: u64) -> (Vec<RunRecord>, Rates) {
    let (tables, scene) = compiled(text);
    let rates = rates_of(&scene);
    let settings = Settings {
        rates: vec![rates.clone()],
        ..Settings::new(Model::Rate, 1)
    };
    let mut watch = |_, _| ControlFlow::Continue(());
    let records = (0..runs).map(|number| {
        let record =
            run(&tables, &scene, &settings, 7, number, &mut watch).expect("the command starts");
        assert_eq!(record.outcome, Outcome::Completed);
        record
    });
    (records.collect(), rates)
}

/// Returns the mean of a sample and the standard error of the mean.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

/// Checks a mean within four standard errors. Chance exceeds this limit once in 16,000 times.
fn agrees(values: &[f64], expected: f64) {
    let (mean, error) = mean(values);
    assert!(
        (mean - expected).abs() < 4.0 * error,
        "{mean} ± {error}, not {expected}"
    );
}

const SINGLE: &str =
    "assembly single { seed plate 1 x 1 { M at (0, 0) } phase only { M.up -> A } }";

#[test]
fn a_single_wait_has_the_distribution_of_the_model() {
    let (records, rates) = records(SINGLE, 4000);
    let bond = &records[0].bonds[0];
    let mut seen = rates.surroundings(
        bond.cell,
        Face::Up,
        Neighbourhood::on_ground(bond.cell),
        |_| None,
    );
    seen.cold = true;
    let wait = rates.wait(&seen);
    let mut waits: Vec<f64> = records.iter().map(|record| record.ticks as f64).collect();
    // A docking is reported at the end of its tick.
    agrees(&waits, wait.mean() + 0.5);
    waits.sort_by(f64::total_cmp);
    let count = waits.len() as f64;
    let apart = waits.iter().enumerate().map(|(i, ticks)| {
        let expected = wait.distribution(*ticks);
        (expected - (i as f64 + 0.5) / count).abs()
    });
    // Kolmogorov-Smirnov test at a level of 1e-4, plus the rounding to ticks.
    let limit = 2.23 / count.sqrt() + wait.rate;
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < limit, "{apart} {limit}");
    assert!(
        records.iter().all(|record| record.bonds[0].entries == 0),
        "no block entered a reach"
    );
}

#[test]
fn fewer_free_blocks_lengthen_waits() {
    // Three of the four blocks are captured when the wait for the last one begins.
    let text = "scene few from hemisphere { free 4 uniform }
        assembly four in few { seed plate 9 x 1 { A at (0, 0) B at (8, 0) }
        phase most { A.up ->> T[1..3] } phase last { B.up -> U } }";
    let (records, rates) = records(text, 3000);
    let (tables, _) = compiled(text);
    let last = |record: &RunRecord| {
        let bond = record.bonds.last().expect("there are four");
        assert_eq!(tables.name(bond.child), "U");
        (bond.docked - bond.magnetized) as f64
    };
    let waits: Vec<f64> = records.iter().map(last).collect();
    let bond = records[0].bonds.last().expect("there are four");
    let mut seen = rates.surroundings(
        bond.cell,
        Face::Up,
        Neighbourhood::on_ground(bond.cell),
        |_| None,
    );
    seen.free = 0.25;
    agrees(&waits, rates.wait(&seen).mean() + 0.5);
}

#[test]
fn a_wait_continues_after_its_surroundings_change() {
    // While the top of the tower waits, a block docks next to it and changes the hazard. The mean
    // of the cumulative hazard until the capture is 1, whatever its parts.
    let text = "assembly pair { seed plate 2 x 1 { A at (0, 0) B at (1, 0) } phase both { A.up -> C B.up -> D } }";
    let (records, rates) = records(text, 4000);
    let used = records.iter().flat_map(|record| {
        let [first, second] = &record.bonds[..] else {
            panic!("there are two")
        };
        let mut alone = rates.surroundings(
            second.cell,
            Face::Up,
            Neighbourhood::on_ground(second.cell),
            |cell| (cell == first.cell).then_some(Face::Up),
        );
        alone.cold = true;
        let mut after = rates.surroundings(
            second.cell,
            Face::Up,
            Neighbourhood::new(second.cell, |cell| cell == first.cell),
            |_| None,
        );
        after.cold = true;
        // The hazard at the beginning depends on the number of free blocks, thinned by chance.
        let before = rates.wait(&alone);
        after.free = 299.0 / 300.0;
        let then = rates.wait(&after);
        let (t, u) = (first.docked as f64, second.docked as f64);
        [
            before.cumulative_hazard(t - 0.5),
            before.cumulative_hazard(t) + then.cumulative_hazard(u - 0.5)
                - then.cumulative_hazard(t),
        ]
    });
    let used: Vec<f64> = used.collect();
    // The first of two blocks docks at half of the sum of both hazards.
    let first: Vec<f64> = used.iter().step_by(2).copied().collect();
    agrees(&first, 0.5);
    let second: Vec<f64> = used.iter().skip(1).step_by(2).copied().collect();
    agrees(&second, 1.5);
}

#[test]
fn a_block_two_cells_away_changes_a_wait() {
    // The top of the tower waits. A block docks two cells from the block below it, before or after.
    let text = "assembly near { seed plate 3 x 1 { A at (0, 0) B at (2, 0) }
        phase foot { A.up -> C } phase both { C.up -> E B.up -> D } }";
    let (records, rates) = records(text, 4000);
    let (tables, _) = compiled(text);
    let used = records.iter().map(|record| {
        let bond = |name: &str| {
            let mut bonds = record.bonds.iter();
            let named = bonds.find(|bond| tables.name(bond.child) == name);
            named.expect("the block docked")
        };
        let (foot, top, near) = (bond("C"), bond("E"), bond("D"));
        let wait = |is_there: bool| {
            let is_full = |cell| cell == foot.cell || (is_there && cell == near.cell);
            let mut seen = rates.surroundings(
                top.cell,
                Face::Up,
                Neighbourhood::new(top.cell, is_full),
                |_| None,
            );
            assert_eq!(seen.near_parent, is_there);
            seen.free = if is_there { 298.0 } else { 299.0 } / 300.0;
            rates.wait(&seen)
        };
        let since = top.magnetized as f64;
        let (came, until) = (near.docked as f64 - since, top.docked as f64 - since - 0.5);
        let (before, then) = (wait(false), wait(true));
        if until < came {
            before.cumulative_hazard(until)
        } else {
            before.cumulative_hazard(came) + then.cumulative_hazard(until)
                - then.cumulative_hazard(came)
        }
    });
    agrees(&used.collect::<Vec<_>>(), 1.0);
}

#[test]
fn a_block_released_at_an_open_face_is_captured_at_once() {
    let text = "assembly swap { seed plate 3 x 1 { A at (0, 0) M at (1, 0) }
        phase arm { A.up -> B.up -> C.east -> D M.up -> E }
        phase over { release D E.up -> F } }";
    let (records, _) = records(text, 300);
    let waits = records.iter().map(|record| {
        let bond = record.bonds.last().expect("there are bonds");
        (bond.docked - bond.magnetized) as f64
    });
    assert!(waits.into_iter().all(|wait| wait == 2.0));
}

#[test]
fn a_block_released_before_a_face_opens_has_often_left() {
    for hop in [0, 1, 20] {
        let text = format!(
            "scene slow from hemisphere {{ messages {{ hop {hop} ticks }} }}
             assembly swap in slow {{ seed plate 3 x 1 {{ A at (0, 0) M at (1, 0) }}
             phase arm {{ A.up -> B.up -> C.east -> D M.up -> E }}
             phase over {{ release D E.up -> F after release D }} }}"
        );
        let (records, rates) = records(&text, 600);
        let last = |record: &RunRecord| record.bonds.last().expect("there are bonds").clone();
        let back = records.iter().map(last).map(|bond| {
            let is_back = matches!(bond.origin, Origin::Released { .. });
            f64::from(u8::from(is_back))
        });
        let (back, error) = mean(&back.collect::<Vec<_>>());
        let bond = last(&records[0]);
        let since = bond.magnetized - records[0].releases[0].tick;
        assert_eq!(since > 0, hop > 0);
        let starts = rates.head_starts();
        let nearby = starts
            .nearby(bond.cell, Face::Up, bond.cell)
            .expect("it is known");
        let expected = (nearby.after(since as f64)).map_or(0.0, |start| start.probability);
        // Sometimes another block docks first, or this block returns later.
        assert!(
            (back - expected).abs() < 4.0 * error + 0.05,
            "{hop}: {back}, not {expected}"
        );
    }
}

/// World that makes every tick instead of skipping.
struct Patient<W>(W);

impl<W> State for Patient<W> {}

impl<W: World> World for Patient<W> {
    fn tick(&self) -> u64 {
        self.0.tick()
    }
    fn magnetize(&mut self, block_face: BlockFace) {
        self.0.magnetize(block_face);
    }
    fn switch_off(&mut self, block_face: BlockFace) {
        self.0.switch_off(block_face);
    }
    fn plant(&mut self, block_face: BlockFace) -> Option<Docking> {
        self.0.plant(block_face)
    }
    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        self.0.step(dockings)
    }
}

#[test]
fn skipping_time_changes_nothing() {
    let texts = [
        SINGLE,
        "scene slow from hemisphere { messages { hop 20 ticks loss 0.3 } }
         assembly late in slow { seed plate 3 x 1 { A at (0, 0) M at (2, 0) }
         phase arm { A.up -> B.up -> C.east -> D M.up -> E }
         phase away { release D E.up -> F after release D }
         phase short timeout 300 ticks { F.up ->> G[1..3] } }",
    ];
    for text in texts {
        let (tables, scene) = compiled(text);
        let rates = [rates_of(&scene)];
        let messages = scene.messages.as_ref();
        for number in 0..40 {
            let mut watch = |_, _| ControlFlow::Continue(());
            for limit in [None, Some(900)] {
                let world =
                    || RateWorld::new(&tables, &scene, &rates, 3, number).expect("it is known");
                let quick = drive(
                    &tables,
                    messages,
                    &mut world(),
                    limit,
                    3,
                    number,
                    &mut watch,
                );
                let slow = drive(
                    &tables,
                    messages,
                    &mut Patient(world()),
                    limit,
                    3,
                    number,
                    &mut watch,
                );
                assert_eq!(quick, slow);
            }
        }
    }
}

#[test]
fn missing_and_inaccurate_rates_are_rejected() {
    let other = "scene other from hemisphere { free 77 uniform }
        assembly single in other { seed plate 1 x 1 { M at (0, 0) } phase only { M.up -> A } }";
    let (tables, scene) = compiled(other);
    let settings = Settings::new(Model::Rate, 1);
    let mut watch = |_, _| ControlFlow::Continue(());
    let error = run(&tables, &scene, &settings, 1, 0, &mut watch).unwrap_err();
    assert!(matches!(error, RunError::Scene(_)));
    let without = error.to_string();
    assert!(without.contains("stochc calibrate"), "{without}");
    let message = refused_in("magnet_tank", 0.286);
    let reason = "a held-out error of 28.6 %";
    assert!(
        message.contains(reason) && message.contains("rigid"),
        "{message}"
    );
    assert_eq!(refused_in("suction_tank", 0.15), "");
}

/// Returns the error of a run in a scene whose rates have a held-out error. Empty without an error.
fn refused_in(scene: &str, error: f64) -> String {
    let text = format!(
        "assembly other in {scene} {{ seed plate 1 x 1 {{ M at (0, 0) }} phase only {{ M.up -> A }} }}"
    );
    let (tables, scene) = compiled(&text);
    let rates = Rates {
        held_out: Some(HeldOut {
            error,
            sampling: 0.0,
        }),
        ..rates_of(&scene)
    };
    let settings = Settings {
        rates: vec![rates],
        ..Settings::new(Model::Rate, 1)
    };
    let mut watch = |_, _| ControlFlow::Continue(());
    let result = run(&tables, &scene, &settings, 1, 0, &mut watch);
    result
        .err()
        .map_or_else(String::new, |error| error.to_string())
}
