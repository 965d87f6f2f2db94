//! Steps that are smaller than the last digit of a place.
use std::fmt::Write as _;

use nalgebra::Vector3;
use stochc_ir::scene::{Agitation, BOLTZMANN, Fluid, Scene};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{Arena, BodyState};
use stochc_runtime::{Model, Precision, Settings};

use crate::scenes::{Dice, PLATE, empty};

const BLOCKS: usize = 400;
const TICKS: u64 = 2000;

/// Cubes of 10 um in warm water, about so many sides from the plate.
fn blocks(far: f64) -> Vec<BodyState> {
    let mut dice = Dice::new(1);
    let place = |_| BodyState::at_rest(far * dice.direction());
    (0..BLOCKS).map(place).collect()
}

/// How far they get over what Einstein's relation says.
fn diffusion<W: Arena>(tick: f64, far: f64, settings: &Settings) -> f64 {
    let (temperature, viscosity, mut scene) = (293.0, 1e-3, empty());
    scene.tick = tick;
    (scene.block.side, scene.block.mass) = (1e-5, 1e-12);
    scene.fluid = Some(Fluid {
        density: None,
        viscosity: Some(viscosity),
    });
    scene.agitation = Some(Agitation::Brownian { temperature });
    let scene: Scene = scene;
    let mut world = W::with_blocks(&scene, &PLATE, settings, 1, 0, &blocks(far)).expect("sound");
    let places = |world: &W| -> Vec<Vector3<f64>> {
        (0..world.count())
            .map(|id| world.state(id).position)
            .collect()
    };
    let mut none = Vec::new();
    // Until the beginning at rest is forgotten.
    for _ in 0..400 {
        world.step(&mut none).expect("sound physics");
    }
    let start = places(&world);
    for _ in 0..TICKS {
        world.step(&mut none).expect("sound physics");
    }
    let squares = places(&world)
        .iter()
        .zip(&start)
        .map(|(a, b)| (a - b).norm_squared())
        .sum::<f64>();
    let friction = Fluid::friction(viscosity, scene.block.side);
    let (rate, time) = (friction / scene.block.mass, tick * TICKS as f64);
    let exact =
        6.0 * BOLTZMANN * temperature / friction * (time + ((-rate * time).exp() - 1.0) / rate);
    squares / BLOCKS as f64 * scene.block.side * scene.block.side / exact
}

/// The table; what is off in our own kernel.
pub fn table(page: &mut String) -> Vec<String> {
    page.push_str(
        "
The next rows are 400 cubes of 10 um in water at 293 K that collide with nobody, so many sides from the plate, for 2000 ticks: how far they
diffuse, over what Einstein's relation says, within 4 %. A place 600 sides away has steps of 6e-5 sides in single precision, which a block moves by in some ten ticks of 1 us; what
rounding takes is kept and added in the next step, so that nothing is lost. Rapier does not do so.

| tick, distance | `rigid` | `rigid`, double precision | `rapier` |
|---|--:|--:|--:|
",
    );
    let single = Settings::of(Model::Rigid, 1);
    let double = Settings {
        precision: Precision::Double,
        ..single.clone()
    };
    let mut off = Vec::new();
    for (name, tick, far) in [
        ("1 us, 6", 1e-6, 6.0),
        ("1 us, 600", 1e-6, 600.0),
        ("0.1 us, 600", 1e-7, 600.0),
        ("0.1 us, 60,000", 1e-7, 60_000.0),
    ] {
        let found = [
            diffusion::<RigidWorld>(tick, far, &single),
            diffusion::<RigidWorld>(tick, far, &double),
            diffusion::<RapierWorld>(tick, far, &single),
        ];
        let [one, two, other] = found.map(|part| 100.0 * part);
        writeln!(page, "| {name} | {one:.0} % | {two:.0} % | {other:.0} % |").expect("memory");
        // 1200 independent squares: 4.1 %, so three standard errors.
        if found[..2].iter().any(|part| (part - 1.0).abs() > 0.12) {
            off.push(format!("{name}: {found:?}"));
        }
    }
    off
}
