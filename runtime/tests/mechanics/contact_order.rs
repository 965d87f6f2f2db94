//! Compares prepared collisions with exact or finely resolved ones: errors and their order in the
//! number of steps.
//!
//! A collision can begin anywhere within a step, so each case consists of many collisions that
//! begin at different moments. If a collision begins late in a step, the damper acts for less of
//! that step. These random errors shrink with the step and have no preferred sign. Only their mean,
//! which shrinks with the square of the step, would shift the results of a simulation.
//! `STOCHC_WRITE_DOCS=1 cargo test -p stochc-runtime --test mechanics contact_order` writes the
//! table of docs/validation/physics.md.

use std::fmt::Write as _;

use crate::scenes::{
    Dice, Double, Kind, at, compliant, empty, energy, hemisphere, pass, states, world,
};
use nalgebra::UnitQuaternion;
use stochc_runtime::world::BodyState;

const PAGE: &str = "../docs/validation/physics.md";
/// Start and end of the table in the page.
const BEGIN: &str = "<!-- collisions -->\n";
const END: &str = "<!-- end of collisions -->\n";

/// Stiffness and damping of the scene `hemisphere_soft`, in block units.
const STIFFNESS: f64 = 0.1;
const DAMPING: f64 = 0.12;

/// Number of collisions per case.
const COUNT: usize = 256;

/// Numbers of steps per tick.
const STEPS: [u32; 5] = [1, 2, 4, 8, 16];

/// Number of steps per tick of the reference solution.
const FINE: u32 = 64;

/// Constructor of blocks that are about to collide.
type Prepare = fn(&mut Dice) -> Vec<BodyState>;

struct Case {
    name: &'static str,
    friction: f64,
    damping: f64,
    prepare: Prepare,
}

fn corner() -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&at(1.0, 1.0, 1.0), &at(0.0, 0.0, 1.0)).expect("not opposite")
}

fn edge() -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(at(std::f64::consts::FRAC_PI_4, 0.0, 0.0))
}

/// Returns two blocks that approach each other, one above the other. The lower one is level, and
/// the upper one extends `reach` downward.
fn head_on(dice: &mut Dice, turned: UnitQuaternion<f64>, reach: f64) -> Vec<BodyState> {
    let speed = 0.13;
    let gap = 0.5 + reach + 2.0 * speed * dice.unit();
    let block = |side: f64, orientation| BodyState {
        orientation,
        velocity: at(0.0, 0.0, -side * speed),
        ..BodyState::at_rest(at(0.0, 0.0, 30.0 + 0.5 * side * gap))
    };
    vec![block(1.0, turned), block(-1.0, UnitQuaternion::identity())]
}

fn face_to_face(dice: &mut Dice) -> Vec<BodyState> {
    head_on(dice, UnitQuaternion::identity(), 0.5)
}

fn edge_to_face(dice: &mut Dice) -> Vec<BodyState> {
    head_on(dice, edge(), 0.5f64.sqrt())
}

fn corner_to_face(dice: &mut Dice) -> Vec<BodyState> {
    head_on(dice, corner(), 0.75f64.sqrt())
}

/// Returns two spinning blocks with random orientations that meet off centre.
fn pair(dice: &mut Dice) -> Vec<BodyState> {
    let direction = dice.direction();
    let aside = dice.direction().cross(&direction).normalize() * (0.5 * dice.unit());
    let speed = 0.07 + 0.1 * dice.unit();
    [1.0, -1.0]
        .map(|side| BodyState {
            position: at(0.0, 0.0, 30.0) + (direction * 0.9 + aside * 0.5) * side,
            orientation: dice.rotation(),
            velocity: -direction * (side * speed),
            spin: 0.1 * dice.direction(),
        })
        .to_vec()
}

/// Returns a spinning block with a random orientation that is about to land.
fn landing(dice: &mut Dice) -> Vec<BodyState> {
    let speed = 0.07 + 0.1 * dice.unit();
    vec![BodyState {
        position: at(0.0, 0.0, 0.9 + 0.2 * dice.unit()),
        orientation: dice.rotation(),
        velocity: at(0.0, 0.0, -speed),
        spin: 0.1 * dice.direction(),
    }]
}

/// Returns a block that lands on an edge and slides across it.
fn sliding(dice: &mut Dice) -> Vec<BodyState> {
    let speed = 0.13;
    vec![BodyState {
        position: at(0.0, 0.0, 0.5f64.sqrt() + speed * dice.unit()),
        orientation: edge(),
        velocity: at(0.25, 0.0, -speed),
        ..BodyState::at_rest(at(0.0, 0.0, 0.0))
    }]
}

const CASES: [Case; 8] = [
    Case {
        name: "face to face",
        friction: 0.0,
        damping: DAMPING,
        prepare: face_to_face,
    },
    Case {
        name: "edge to face",
        friction: 0.0,
        damping: DAMPING,
        prepare: edge_to_face,
    },
    Case {
        name: "corner to face",
        friction: 0.0,
        damping: DAMPING,
        prepare: corner_to_face,
    },
    Case {
        name: "any pair, with spin",
        friction: 0.0,
        damping: DAMPING,
        prepare: pair,
    },
    Case {
        name: "the same, friction 1",
        friction: 1.0,
        damping: DAMPING,
        prepare: pair,
    },
    Case {
        name: "the same, undamped and frictionless",
        friction: 0.0,
        damping: 0.0,
        prepare: pair,
    },
    Case {
        name: "landing, with spin",
        friction: 0.0,
        damping: DAMPING,
        prepare: landing,
    },
    Case {
        name: "landing on an edge, sliding, friction 0.3",
        friction: 0.3,
        damping: DAMPING,
        prepare: sliding,
    },
];

/// Returns, for each collision of a case, the ratio of the energies after and before.
fn left(case: &Case, steps: u32) -> Vec<f64> {
    let mut scene = empty();
    scene.contact = compliant(STIFFNESS, case.damping, case.friction);
    scene.enclosure = hemisphere(100.0, 0.01);
    let mut dice = Dice::new(3);
    let collide = |_| {
        let blocks = (case.prepare)(&mut dice);
        let before: f64 = blocks.iter().map(energy).sum();
        let mut arena: <Double as Kind>::World =
            world(&scene, &Double::with_substeps(steps), &blocks);
        pass(&mut arena, 100);
        states(&arena).iter().map(energy).sum::<f64>() / before
    };
    (0..COUNT).map(collide).collect()
}

/// Returns the mean and root mean square of a sample.
fn moments(sample: &[f64]) -> [f64; 2] {
    let n = sample.len() as f64;
    [
        sample.iter().sum::<f64>() / n,
        (sample.iter().map(|x| x * x).sum::<f64>() / n).sqrt(),
    ]
}

/// Returns the limit of small steps. Without damping and friction no energy is lost.
fn exact(case: &Case) -> Vec<f64> {
    if case.damping == 0.0 {
        return vec![1.0; COUNT];
    }
    left(case, FINE)
}

/// Returns the errors of the remaining energy, mean and rms, for each number of steps.
fn errors(case: &Case) -> [[f64; 2]; STEPS.len()] {
    let exact = exact(case);
    STEPS.map(|steps| {
        let off: Vec<f64> = (left(case, steps).iter().zip(&exact))
            .map(|(a, b)| a - b)
            .collect();
        moments(&off)
    })
}

/// Limit below which a mean is not significant: twice its standard error at one step per tick.
const CHANCE: f64 = 0.01;

#[test]
fn errors_converge_as_documented() {
    let mut table = String::from(
        "| collision | energy left | 1 step | 2 | 4 | 8 | 16 |\n|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for case in &CASES {
        let errors = errors(case);
        let [exact, _] = moments(&exact(case));
        write!(table, "| {} | {:.1} % |", case.name, 100.0 * exact).expect("memory");
        for [mean, rms] in errors {
            write!(table, " {:+.1} ({:.1}) |", 100.0 * mean, 100.0 * rms).expect("memory");
        }
        table.push('\n');
        for (coarse, fine) in errors.iter().zip(&errors[2..]) {
            // With four times as many steps, single errors shrink in first order, means in second
            // order.
            assert!(fine[1] < coarse[1] / 2.0, "{}: {errors:?}", case.name);
            assert!(
                fine[0].abs() < coarse[0].abs() / 8.0 + CHANCE,
                "{}: {errors:?}",
                case.name
            );
        }
    }
    crate::pages::assert_part(PAGE, [BEGIN, END], &table);
}

/// All three head-on cases are damped oscillators of two blocks. They end at a phase of pi - 2 a.
#[test]
fn head_on_collisions_are_exact_in_the_mean() {
    for case in &CASES[..3] {
        let frequency = (2.0 * STIFFNESS).sqrt();
        let angle = f64::asin(DAMPING / frequency);
        let back = (-angle.tan() * (std::f64::consts::PI - 2.0 * angle)).exp();
        for steps in [1, 2, 4] {
            let [mean, _] = moments(&left(case, steps));
            let off = mean - back * back;
            assert!(
                off.abs() < 0.01 / f64::from(steps),
                "{} {steps}: {off}",
                case.name
            );
        }
    }
}
