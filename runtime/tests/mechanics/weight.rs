//! Tests blocks with weight that fall on the ground and come to rest, with rigid contacts.

use crate::scenes::{Kind, at, contact, empty, hemisphere, states, world};
use nalgebra::Vector3;
use stochc_ir::scene::{Mount, Scene};
use stochc_runtime::world::{BodyState, World};

in_either_precision!(
    a_cube_falls_in_the_direction_of_gravity,
    an_elastic_cube_rises_as_high_as_it_fell,
    an_inelastic_cube_rises_no_higher_than_it_should,
    a_cube_that_lies_stays,
    a_heavy_cube_slides_as_far_as_coulomb_says,
);

/// Acceleration of gravity. Unit: block lengths per square tick.
const WEIGHT: f64 = 0.0025;

const STEPS: [u32; 4] = [1, 2, 4, 32];

fn ground(restitution: f64, friction: f64) -> Scene {
    Scene {
        gravity: Some(WEIGHT),
        contact: contact(restitution, friction),
        enclosure: hemisphere(100.0, 0.01),
        ..empty()
    }
}

/// Returns the states of a cube over `ticks` ticks. It starts `height` above its position at rest.
fn path<K: Kind>(
    scene: &Scene,
    substeps: u32,
    height: f64,
    velocity: Vector3<f64>,
    ticks: usize,
) -> Vec<BodyState> {
    let block = BodyState {
        velocity,
        ..BodyState::at_rest(at(0.0, 0.0, 0.5 + height))
    };
    let mut world: K::World = world(scene, &K::with_substeps(substeps), &[block]);
    let mut dockings = Vec::new();
    let states = (0..ticks).map(|_| {
        world.step(&mut dockings).expect("the physics is stable");
        states(&world)[0]
    });
    states.collect()
}

/// Returns the maxima of the height above the position at rest.
fn peaks(path: &[BodyState]) -> Vec<f64> {
    let heights: Vec<f64> = path.iter().map(|it| it.position.z - 0.5).collect();
    let is_peak = |it: &&[f64]| it[0] < it[1] && it[1] >= it[2];
    heights.windows(3).filter(is_peak).map(|it| it[1]).collect()
}

/// Checks the path g t² / 2 with a plate on the floor, on a wall and on the roof. The velocity changes
/// before each step, so the path is longer by half a step.
fn a_cube_falls_in_the_direction_of_gravity<K: Kind>() {
    for (mount, direction) in [
        (None, [0.0, 0.0, -1.0]),
        (Some(Mount::Wall), [0.0, -1.0, 0.0]),
        (Some(Mount::Roof), [0.0, 0.0, 1.0]),
    ] {
        let scene = Scene {
            mount,
            ..ground(0.0, 0.0)
        };
        let path = path::<K>(&scene, 4, 20.0, Vector3::zeros(), 40);
        let fallen = path[39].position - at(0.0, 0.0, 20.5);
        let expected = WEIGHT * 40.0 * 40.25 / 2.0;
        let error = (fallen - Vector3::from(direction) * expected).norm();
        assert!(error < 1e-4, "{mount:?}: {fallen}");
    }
}

/// A maximum can fall between two ticks, so it appears lower by up to g/8.
fn an_elastic_cube_rises_as_high_as_it_fell<K: Kind>() {
    for substeps in STEPS {
        let path = path::<K>(&ground(1.0, 0.0), substeps, 20.0, Vector3::zeros(), 2000);
        let peaks = peaks(&path);
        assert!(peaks.len() >= 6, "{peaks:?}");
        for peak in peaks {
            assert!((peak - 20.0).abs() < 0.002, "{substeps}: {peak}");
        }
    }
}

/// When the cube bounces, it may have fallen too far by up to one step. A part 1 - e^2 of that
/// height is lost.
fn an_inelastic_cube_rises_no_higher_than_it_should<K: Kind>() {
    for substeps in STEPS {
        let path = path::<K>(&ground(0.5, 0.0), substeps, 20.0, Vector3::zeros(), 220);
        let peak = peaks(&path)[0];
        let distance = (2.0 * WEIGHT * 20.0).sqrt() / f64::from(substeps);
        assert!(peak < 5.0 + 0.001, "{substeps}: {peak}");
        assert!(peak > 5.0 - 0.75 * distance - 0.001, "{substeps}: {peak}");
    }
}

fn a_cube_that_lies_stays<K: Kind>() {
    for restitution in [0.0, 0.5] {
        for substeps in STEPS {
            let scene = ground(restitution, 0.3);
            let path = path::<K>(&scene, substeps, 0.1, Vector3::zeros(), 1000);
            let last = &path[path.len() - 100..];
            for block in last {
                let depth = 0.5 - block.position.z;
                assert!((-0.001..0.002).contains(&depth), "{substeps}: {depth}");
                assert!(block.velocity.norm() < 1e-4, "{substeps}: {block:?}");
            }
        }
    }
}

fn a_heavy_cube_slides_as_far_as_coulomb_says<K: Kind>() {
    let speed = 0.05;
    for substeps in STEPS {
        let scene = ground(0.0, 0.3);
        let path = path::<K>(&scene, substeps, 0.0, at(speed, 0.0, 0.0), 200);
        let end = path[path.len() - 1].position.x;
        let distance = speed * speed / (2.0 * 0.3 * WEIGHT);
        assert!(
            (end / distance - 1.0).abs() < 0.02,
            "{substeps}: {end} of {distance}"
        );
    }
}
