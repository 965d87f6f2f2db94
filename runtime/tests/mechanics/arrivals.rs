//! Compares arrival rates of blocks of an ideal gas at a face and at the shell with kinetic theory.

use crate::scenes::{Dice, attract, empty, hemisphere, pass, world};
use nalgebra::Vector3;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld};
use stochc_runtime::{Model, Settings};

in_every_world!(
    entries_into_the_reach_of_a_face_are_a_quarter_of_density_speed_and_area,
    arrivals_at_the_shell_are_a_quarter_of_density_speed_and_area,
);

const SPEED: f64 = 0.1;

/// Returns `count` blocks, spread evenly over a ball, with equal speeds and random directions and
/// orientations.
fn gas(count: usize, radius: f64) -> Vec<BodyState> {
    let mut dice = Dice::new(11);
    let block = |_| BodyState {
        position: radius * dice.unit().cbrt() * dice.direction(),
        orientation: dice.rotation(),
        velocity: SPEED * dice.direction(),
        spin: Vector3::zeros(),
    };
    (0..count).map(block).collect()
}

fn density(count: usize, radius: f64) -> f64 {
    count as f64 / (4.0 / 3.0 * std::f64::consts::PI * radius.powi(3))
}

/// Estimates by Monte Carlo the surface area of a region. The nearest face of a
/// block in this region is within `reach` of a point. The region consists of six balls, each half a
/// block length off the point.
fn effective_area(reach: f64) -> f64 {
    let mut dice = Dice::new(12);
    let (mut bare, samples) = (0, 20_000);
    for _ in 0..samples {
        let position = dice.direction() * reach + Vector3::new(0.5, 0.0, 0.0);
        let covered = Face::ALL.iter().any(|face| {
            let centre = Vector3::from(face.normal()).cast::<f64>() * 0.5;
            (position - centre).norm() < reach * (1.0 - 1e-9)
        });
        bare += usize::from(!covered);
    }
    6.0 * 4.0 * std::f64::consts::PI * reach * reach * bare as f64 / samples as f64
}

fn entries_into_the_reach_of_a_face_are_a_quarter_of_density_speed_and_area<W: SpatialWorld>() {
    let (count, radius, ticks) = (8000, 12.5, 90);
    let mut scene = empty();
    // A magnet without force that never anchors.
    scene.bond = attract(0.0, 0.0);
    let mut world: W = world(
        &scene,
        &Settings::new(Model::Rapier, 1),
        &gas(count, radius),
    );
    let face = Face::Up;
    for block_face in 0..9 {
        let body = Body::Seed(Cell::new(block_face % 3, block_face / 3, 0));
        world.magnetize(BlockFace { body, face });
    }
    pass(&mut world, 1);
    let entries = |world: &W| {
        world
            .active()
            .iter()
            .map(|&(_, entries)| f64::from(entries))
            .sum::<f64>()
    };
    let before = entries(&world);
    pass(&mut world, ticks);
    let found = entries(&world) - before;
    let area = 9.0 * effective_area(1.0);
    let expected = density(count, radius) * SPEED * area / 4.0 * ticks as f64;
    // Neighbouring faces share many of the roughly 490 entries, so their standard error is about 7
    // %.
    assert!(expected > 400.0);
    assert!(
        (found / expected - 1.0).abs() < 0.2,
        "{found} instead of {expected}"
    );
}

fn arrivals_at_the_shell_are_a_quarter_of_density_speed_and_area<W: SpatialWorld>() {
    let (count, radius, ticks) = (4000, 20.0, 100);
    let mut scene = empty();
    scene.enclosure = hemisphere(radius, 0.04);
    let mut world: W = world(
        &scene,
        &Settings::new(Model::Rapier, 1),
        &gas(count, radius),
    );
    let mut outside = vec![false; count];
    let mut found = 0.0;
    for _ in 0..ticks {
        pass(&mut world, 1);
        for (id, was) in outside.iter_mut().enumerate() {
            let is = world.state(id as u32).position.norm() > radius;
            found += f64::from(u8::from(is && !*was));
            *was = is;
        }
    }
    let area = 4.0 * std::f64::consts::PI * radius * radius;
    let expected = density(count, radius) * SPEED * area / 4.0 * f64::from(ticks);
    assert!(expected > 1000.0);
    assert!(
        (found / expected - 1.0).abs() < 0.1,
        "{found} instead of {expected}"
    );
}
