//! Compares the world of rigid blocks with closed forms.

use crate::scenes::{Dice, attract, contact, empty, hemisphere, kicks, pass, world};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::Drag;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld};
use stochc_runtime::{Model, Settings};

in_every_world!(
    free_flight_is_exact,
    kicks_make_a_random_walk_of_the_velocity,
    drag_makes_the_velocity_stationary_and_normal,
    drag_and_kicks_make_blocks_diffuse,
    elastic_collisions_keep_momentum_and_energy,
    the_shell_is_a_spring,
    an_absent_term_is_not_there,
    a_magnet_pulls_the_nearest_face_with_constant_force_within_its_reach,
    the_corners_turn_a_close_block_to_the_nearest_quarter_turn,
);

fn states(world: &impl SpatialWorld) -> Vec<BodyState> {
    (0..world.count()).map(|id| world.state(id)).collect()
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().sum::<f64>() / values.count() as f64
}

fn at(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

fn free_flight_is_exact<W: SpatialWorld>() {
    let start = BodyState {
        velocity: at(0.25, -0.125, 0.0625),
        spin: at(0.0, 0.0, 0.0078125),
        ..BodyState::at_rest(at(1.0, 2.0, 3.0))
    };
    for substeps in [1, 4] {
        let settings = Settings {
            substeps,
            ..Settings::new(Model::Rapier, 1)
        };
        let mut world: W = world(&empty(), &settings, &[start]);
        pass(&mut world, 256);
        let end = world.state(0);
        // All values are powers of two, so there is no rounding.
        assert_eq!(end.position, start.position + 256.0 * start.velocity);
        assert_eq!((end.velocity, end.spin), (start.velocity, start.spin));
        assert!((end.orientation.scaled_axis() - 256.0 * start.spin).norm() < 1e-3);
    }
}

fn kicks_make_a_random_walk_of_the_velocity<W: SpatialWorld>() {
    let (rms, ticks, blocks) = (0.01, 60, 4000);
    let mut scene = empty();
    scene.agitation = kicks(rms);
    for substeps in [1, 3] {
        let settings = Settings {
            substeps,
            ..Settings::new(Model::Rapier, 1)
        };
        let mut world: W = world(
            &scene,
            &settings,
            &vec![BodyState::at_rest(Vector3::zeros()); blocks],
        );
        pass(&mut world, ticks);
        let end = states(&world);
        // <v^2> = n j^2. A kick acts on the whole tick of its impulse. So k ticks later it has
        // moved the block k times as far: <x^2> = j^2 (1 + 4 + ... + n^2).
        let n = ticks as f64;
        let speed = n * rms * rms;
        let path = rms * rms * n * (n + 1.0) * (2.0 * n + 1.0) / 6.0;
        // The mean square of 12,000 components has a standard error of 1.3 %; the limit is four of
        // these.
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.052;
        assert!(close(
            mean(end.iter().map(|b| b.velocity.norm_squared())),
            speed
        ));
        assert!(close(
            mean(end.iter().map(|b| b.position.norm_squared())),
            path
        ));
        for axis in 0..3 {
            let drift = mean(end.iter().map(|b| b.velocity[axis]));
            assert!(drift.abs() < 4.0 * (speed / 3.0 / blocks as f64).sqrt());
        }
        assert!(end.iter().all(|b| b.spin == Vector3::zeros()));
    }
}

fn drag_makes_the_velocity_stationary_and_normal<W: SpatialWorld>() {
    let (rms, rate, blocks) = (0.01, 0.04, 3000);
    let mut scene = empty();
    scene.agitation = kicks(rms);
    scene.drag = Some(Drag { rate });
    let settings = Settings::new(Model::Rapier, 1);
    let mut world: W = world(
        &scene,
        &settings,
        &vec![BodyState::at_rest(Vector3::zeros()); blocks],
    );
    pass(&mut world, 250);
    // v' = f (v + kick) with f = exp(-rate), so <v^2> = j^2 f^2 / (1 - f^2).
    let factor = (-2.0 * rate).exp();
    let sigma = (rms * rms / 3.0 * factor / (1.0 - factor)).sqrt();
    let mut components: Vec<f64> = states(&world)
        .iter()
        .flat_map(|b| [b.velocity.x, b.velocity.y, b.velocity.z])
        .collect();
    components.sort_by(f64::total_cmp);
    // Kolmogorov-Smirnov test. Chance exceeds 1.95 / sqrt(n) in one of 1,000 cases.
    let n = components.len() as f64;
    let gap = components.iter().enumerate().map(|(i, &v)| {
        let normal = 0.5 * libm::erfc(-v / (sigma * std::f64::consts::SQRT_2));
        (normal - i as f64 / n)
            .abs()
            .max((normal - (i + 1) as f64 / n).abs())
    });
    assert!(gap.fold(0.0, f64::max) < 1.95 / n.sqrt());
}

fn drag_and_kicks_make_blocks_diffuse<W: SpatialWorld>() {
    let (rms, rate, ticks, blocks) = (0.01, 0.1, 120, 3000);
    let mut scene = empty();
    scene.agitation = kicks(rms);
    scene.drag = Some(Drag { rate });
    let settings = Settings::new(Model::Rapier, 1);
    let start = vec![BodyState::at_rest(Vector3::zeros()); blocks];
    let mut world: W = world(&scene, &settings, &start);
    pass(&mut world, ticks);
    // A kick k moves a block by k (f + ... + f^m) within m ticks, with f = exp(-rate). So <x^2> =
    // j^2 f^2 / (1 - f)^2 times the sum of (1 - f^m)^2.
    let f = (-rate).exp();
    let sum: f64 = (1..=ticks as i32).map(|m| (1.0 - f.powi(m)).powi(2)).sum();
    let expected = (rms * f / (1.0 - f)).powi(2) * sum;
    let found = mean(states(&world).iter().map(|b| b.position.norm_squared()));
    // The mean square of 9,000 components has a standard error of 1.5 %; the limit is four of
    // these.
    assert!(
        (found / expected - 1.0).abs() < 0.06,
        "{found} instead of {expected}"
    );
    // Long times approach diffusion with D = j^2 / (6 rate^2) per tick. The start deviates by up to
    // 1.5 / (rate n).
    let diffusion = rms * rms / (rate * rate) * ticks as f64;
    assert!((expected / diffusion - 1.0).abs() < 2.5 / (rate * ticks as f64));
}

fn elastic_collisions_keep_momentum_and_energy<W: SpatialWorld>() {
    let mut scene = empty();
    scene.contact = contact(1.0, 0.0);
    let settings = Settings {
        substeps: 8,
        ..Settings::new(Model::Rapier, 1)
    };
    let energy = |b: &BodyState| 0.5 * b.velocity.norm_squared() + b.spin.norm_squared() / 12.0;
    let mut changes = Vec::new();
    for case in 0..40 {
        let mut dice = Dice::new(case);
        let mut block = |x: f64, speed: f64| BodyState {
            position: at(x, 0.6 * dice.unit(), 50.0 + 0.6 * dice.unit()),
            orientation: dice.rotation(),
            velocity: at(speed, 0.0, 0.0),
            spin: 0.05 * dice.direction(),
        };
        let start = [block(-1.5, 0.1), block(1.5, -0.1)];
        let mut world: W = world(&scene, &settings, &start);
        pass(&mut world, 60);
        let end = states(&world);
        let sum = |f: &dyn Fn(&BodyState) -> Vector3<f64>, of: &[BodyState]| f(&of[0]) + f(&of[1]);
        let momentum = |b: &BodyState| b.velocity;
        let middle = at(0.0, 0.0, 50.0);
        let angular = |b: &BodyState| (b.position - middle).cross(&b.velocity) + b.spin / 6.0;
        assert!((sum(&momentum, &start) - sum(&momentum, &end)).norm() < 1e-5);
        // Two blocks touch at gaps up to the engine's margin of 0.1.
        assert!((sum(&angular, &start) - sum(&angular, &end)).norm() < 0.015);
        if (end[0].velocity - start[0].velocity).norm() > 1e-3 {
            let [before, after] =
                [&start[..], &end[..]].map(|of| of.iter().map(energy).sum::<f64>());
            changes.push((after / before - 1.0).abs());
        }
    }
    changes.sort_by(f64::total_cmp);
    assert!(changes.len() > 35, "only {} of 40 met", changes.len());
    assert!(changes[changes.len() / 2] < 1e-5);
    // The engine is less exact for an edge or a face that hits at several points at once.
    assert!(changes[changes.len() - 1] < 0.1);
}

fn the_shell_is_a_spring<W: SpatialWorld>() {
    let (radius, wall) = (10.0, 0.01);
    let mut scene = empty();
    scene.enclosure = hemisphere(radius, wall);
    let out = at(0.6, 0.0, 0.8);
    let start = BodyState {
        velocity: 0.1 * out,
        ..BodyState::at_rest((radius - 0.95) * out)
    };
    for substeps in [1, 4] {
        let settings = Settings {
            substeps,
            ..Settings::new(Model::Rapier, 1)
        };
        let mut world: W = world(&scene, &settings, &[start]);
        let (mut outside, mut deepest) = (0.0, 0.0f64);
        for _ in 0..60 {
            pass(&mut world, 1);
            let depth = world.state(0).position.norm() - radius;
            outside += f64::from(u8::from(depth > 0.0));
            deepest = deepest.max(depth);
        }
        // The contact lasts half a period of sqrt(wall / mass), is speed / frequency deep, and
        // conserves the speed.
        let frequency = f64::sqrt(wall);
        assert!(
            (outside - std::f64::consts::PI / frequency).abs() <= 1.0,
            "{outside}"
        );
        assert!((deepest - 0.1 / frequency).abs() < 0.02, "{deepest}");
        let back = world.state(0).velocity + start.velocity;
        assert!(back.norm() < 0.003, "{back}");
    }
}

fn an_absent_term_is_not_there<W: SpatialWorld>() {
    let mut scene = empty();
    // Without contact, blocks pass through each other and through the plate.
    let towards = |z: f64, speed: f64| BodyState {
        velocity: at(0.0, 0.0, speed),
        ..BodyState::at_rest(at(0.0, 0.0, z))
    };
    let blocks = [towards(4.0, -0.25), towards(-4.0, 0.25)];
    let mut through: W = world(&scene, &Settings::new(Model::Rapier, 1), &blocks);
    pass(&mut through, 64);
    assert_eq!(through.state(0).position, at(0.0, 0.0, -12.0));
    assert_eq!(through.state(1).position, at(0.0, 0.0, 12.0));
    // With contact, they stay above the plate.
    scene.contact = contact(0.0, 0.2);
    scene.enclosure = hemisphere(25.0, 0.01);
    scene.bond = attract(0.03, 0.005);
    let mut held: W = world(&scene, &Settings::new(Model::Rapier, 1), &blocks[..1]);
    pass(&mut held, 64);
    assert!(held.state(0).position.z > 0.4);
}

/// Returns a block at rest after one tick under the magnet in the middle of the plate.
fn magnetized<W: SpatialWorld>(block: BodyState) -> BodyState {
    let mut scene = empty();
    scene.bond = attract(PULL, 0.0);
    let mut world: W = world(&scene, &Settings::new(Model::Rapier, 1), &[block]);
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    world.magnetize(BlockFace { body, face });
    pass(&mut world, 1);
    world.state(0)
}

const PULL: f64 = 0.01;

fn a_magnet_pulls_the_nearest_face_with_constant_force_within_its_reach<W: SpatialWorld>() {
    for height in [0.55, 0.8, 0.99] {
        let pulled = magnetized::<W>(BodyState::at_rest(at(0.0, 0.0, 0.5 + height)));
        assert!((pulled.velocity - at(0.0, 0.0, -PULL)).norm() < 1e-6);
        assert!(pulled.spin.norm() < 1e-6);
    }
    // The lower face of this block is at (0.3, 0, 0.7), half a block length below its centre.
    let pulled = magnetized::<W>(BodyState::at_rest(at(0.3, 0.0, 1.2)));
    let force = PULL * at(-0.3, 0.0, -0.7).normalize();
    assert!((pulled.velocity - force).norm() < 1e-6);
    let torque = at(0.0, 0.0, -0.5).cross(&force);
    assert!((pulled.spin - 6.0 * torque).norm() < 1e-6);
    for out_of_reach in [at(0.0, 0.0, 1.51), at(0.8, 0.0, 1.2)] {
        let left = BodyState::at_rest(out_of_reach);
        assert_eq!(magnetized::<W>(left).velocity, left.velocity);
    }
}

fn the_corners_turn_a_close_block_to_the_nearest_quarter_turn<W: SpatialWorld>() {
    for (degrees, sign) in [(10, -1.0), (40, -1.0), (50, 1.0), (80, 1.0), (95, -1.0)] {
        let yaw = f64::from(degrees).to_radians();
        let turned = magnetized::<W>(BodyState {
            orientation: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
            ..BodyState::at_rest(at(0.0, 0.0, 0.9))
        });
        assert!(turned.spin.z * sign > 1e-5, "{degrees}: {}", turned.spin);
        assert!(turned.spin.xy().norm() < 1e-6);
        // The pull, plus four corner forces of a twentieth each, almost straight down.
        let speed = -turned.velocity.z / PULL;
        assert!((1.1..=1.2).contains(&speed), "{speed}");
    }
    // Beyond the second reach, nothing turns the block.
    let far = magnetized::<W>(BodyState {
        orientation: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3),
        ..BodyState::at_rest(at(0.0, 0.0, 1.1))
    });
    assert!(far.spin.norm() < 1e-6);
}
