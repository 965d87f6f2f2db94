//! Compares gravity, fluids and heat with closed forms, in both worlds.

use crate::scenes::{at, empty, kicks, pass, states, world};
use nalgebra::Vector3;
use stochc_ir::scene::dimensionless::speed;
use stochc_ir::scene::{
    Agitation, BOLTZMANN, Enclosure, Flow, Fluid, Jets, Scene, Stir, Strength, Turbulence,
};
use stochc_runtime::world::{BodyState, SpatialWorld};
use stochc_runtime::{Model, Settings};

in_every_world!(
    a_block_falls_freely_without_a_fluid,
    a_block_sinks_at_its_terminal_speed_whatever_the_step,
    a_lighter_block_rises,
    a_block_with_added_mass_starts_more_slowly_and_ends_as_fast,
    a_force_on_the_fluid_moves_a_neutral_block_with_added_mass_like_the_fluid,
    brownian_blocks_with_added_mass_have_the_energy_of_their_temperature,
    viscous_drag_slows_exponentially,
    a_wake_slows_algebraically,
    a_turning_block_is_slowed_too,
    kicks_against_wakes_come_to_the_expected_speed,
    kicks_in_a_viscous_fluid_move_blocks_alike_at_every_step,
    a_neutral_block_stays_on_its_circle_in_a_vortex,
    brownian_blocks_diffuse_as_einstein_says_at_every_step,
    brownian_blocks_have_the_energy_of_their_temperature,
    blocks_follow_eddies_and_disperse_as_taylor_says,
    a_jet_carries_a_block_to_the_middle,
    a_sphere_keeps_its_blocks,
);

/// Returns a scene whose SI units and block units are the same.
fn fluid(density: Option<f64>, viscosity: Option<f64>) -> Scene {
    Scene {
        fluid: Some(Fluid {
            density,
            viscosity,
            added_mass: None,
        }),
        ..empty()
    }
}

fn settings(substeps: u32) -> Settings {
    Settings::new(Model::Rapier, substeps)
}

/// Returns the viscosity that makes a velocity decay at this rate.
fn viscosity(rate: f64) -> f64 {
    rate / Fluid::friction(1.0, 1.0)
}

fn moving(velocity: Vector3<f64>, spin: Vector3<f64>) -> BodyState {
    BodyState {
        velocity,
        spin,
        ..BodyState::at_rest(at(0.0, 0.0, 100.0))
    }
}

fn still() -> BodyState {
    moving(Vector3::zeros(), Vector3::zeros())
}

fn a_block_falls_freely_without_a_fluid<W: SpatialWorld>() {
    let scene = Scene {
        gravity: Some(0.002),
        ..empty()
    };
    let mut world: W = world(&scene, &settings(2), &[still()]);
    pass(&mut world, 50);
    let block = world.state(0);
    assert!((block.velocity.z + 0.1).abs() < 1e-6, "{block:?}");
    // Symplectic Euler in steps of h gives g h^2 n (n + 1) / 2.
    let fall = 0.002 * 0.25 * 100.0 * 101.0 / 2.0;
    assert!((100.0 - block.position.z - fall).abs() < 1e-4, "{block:?}");
}

fn a_block_sinks_at_its_terminal_speed_whatever_the_step<W: SpatialWorld>() {
    for (rate, substeps) in [(0.1, 1), (0.1, 4), (3.0, 1), (30.0, 1), (30.0, 7)] {
        let mut scene = fluid(None, Some(viscosity(rate)));
        scene.gravity = Some(0.02);
        let mut world: W = world(&scene, &settings(substeps), &[still()]);
        pass(&mut world, 400);
        let speed = -world.state(0).velocity.z;
        assert!((speed * rate / 0.02 - 1.0).abs() < 1e-4, "{rate}: {speed}");
    }
    // With a wake only, m g (1 - rho) = rho v^2 / 2.
    let mut scene = fluid(Some(0.4), None);
    scene.gravity = Some(0.001);
    let mut world: W = world(&scene, &settings(4), &[still()]);
    pass(&mut world, 1000);
    let speed = -world.state(0).velocity.z;
    let terminal = (2.0 * 0.6 * 0.001 / 0.4_f64).sqrt();
    assert!((speed / terminal - 1.0).abs() < 0.005, "{speed} {terminal}");
}

fn a_lighter_block_rises<W: SpatialWorld>() {
    let mut scene = fluid(Some(1.5), Some(viscosity(0.5)));
    scene.gravity = Some(1e-4);
    let mut world: W = world(&scene, &settings(1), &[still()]);
    pass(&mut world, 100);
    let speed = world.state(0).velocity.z;
    assert!((speed / (0.5e-4 / 0.5) - 1.0).abs() < 1e-3, "{speed}");
}

/// Returns a scene with this density and added mass, and little drag at the speeds of these tests.
fn with_added_mass(density: f64, added_mass: f64, rate: f64) -> Scene {
    let mut scene = fluid(Some(density), Some(viscosity(rate)));
    scene.fluid.as_mut().unwrap().added_mass = Some(added_mass);
    scene
}

fn a_block_with_added_mass_starts_more_slowly_and_ends_as_fast<W: SpatialWorld>() {
    let (density, added_mass, rate, gravity) = (0.8, 0.64, 0.1, 1e-5);
    let inertial = 1.0 + added_mass * density;
    let weight = gravity * (1.0 - density);
    for substeps in [1, 4] {
        let mut scene = with_added_mass(density, added_mass, rate);
        scene.gravity = Some(gravity);
        let mut world: W = world(&scene, &settings(substeps), &[still()]);
        let mut passed = 0;
        // From rest the block accelerates at weight / inertial. It approaches weight / rate within
        // inertial / rate.
        for ticks in [1, 15, 200] {
            pass(&mut world, ticks - passed);
            passed = ticks;
            let exact = weight / rate * -(-rate * ticks as f64 / inertial).exp_m1();
            let speed = -world.state(0).velocity.z;
            assert!(
                (speed / exact - 1.0).abs() < 1e-3,
                "{ticks}: {speed} {exact}"
            );
        }
    }
}

fn a_force_on_the_fluid_moves_a_neutral_block_with_added_mass_like_the_fluid<W: SpatialWorld>() {
    let (rate, radius) = (0.01, 4.0);
    let mut scene = with_added_mass(1.0, 0.64, 1e-6);
    scene.flow = Some(Flow::Stir(Stir {
        radius: 8.0,
        rate,
        force: None,
        follow: 1.0,
    }));
    let start = BodyState {
        velocity: at(0.0, rate * radius, 0.0),
        spin: at(0.0, 0.0, rate),
        ..BodyState::at_rest(at(radius, 0.0, 100.0))
    };
    let mut world: W = world(&scene, &settings(4), &[start]);
    pass(&mut world, 600);
    let distance = world.state(0).position.xy().norm();
    assert!((distance / radius - 1.0).abs() < 0.01, "{distance}");
}

fn brownian_blocks_with_added_mass_have_the_energy_of_their_temperature<W: SpatialWorld>() {
    let (count, energy, added_mass) = (4000, 1e-8, 0.64);
    let mut scene = with_added_mass(1.0, added_mass, 0.05);
    scene.agitation = hot(energy);
    let mut world: W = world(&scene, &settings(2), &many(count));
    pass(&mut world, 250);
    let squares = states(&world)
        .iter()
        .map(|block| block.velocity.norm_squared())
        .sum::<f64>();
    let moving = (1.0 + added_mass) * squares / (3.0 * count as f64);
    // 12,000 squares have a standard error of 1.3 %; the limit is four of these.
    assert!((moving / energy - 1.0).abs() < 0.052, "{moving}");
}

fn viscous_drag_slows_exponentially<W: SpatialWorld>() {
    let start = moving(at(0.3, -0.2, 0.1), Vector3::zeros());
    for substeps in [1, 3] {
        let scene = fluid(None, Some(viscosity(0.05)));
        let mut world: W = world(&scene, &settings(substeps), &[start]);
        pass(&mut world, 20);
        let left = world.state(0).velocity.norm() / start.velocity.norm();
        assert!((left - (-1.0_f64).exp()).abs() < 1e-5, "{left}");
    }
}

fn a_wake_slows_algebraically<W: SpatialWorld>() {
    let start = moving(at(0.4, 0.0, 0.0), Vector3::zeros());
    let mut world: W = world(&fluid(Some(0.8), None), &settings(2), &[start]);
    pass(&mut world, 30);
    // v' = -rho v^2 / 2
    let exact = 0.4 / (1.0 + 0.4 * 0.4 * 30.0);
    let speed = world.state(0).velocity.x;
    assert!((speed / exact - 1.0).abs() < 1e-5, "{speed} {exact}");
}

fn kicks_against_wakes_come_to_the_expected_speed<W: SpatialWorld>() {
    let scene = Scene {
        agitation: kicks(0.02),
        ..fluid(Some(0.5), None)
    };
    let mut world: W = world(&scene, &settings(2), &vec![still(); 3000]);
    pass(&mut world, 300);
    let states = states(&world);
    let square = states.iter().map(|b| b.velocity.norm_squared());
    let found = (square.sum::<f64>() / states.len() as f64).sqrt();
    let expected = speed(&scene).rms.unwrap();
    // Without collisions the speeds are not quite Maxwellian (1.7 %). Chance adds 1 %.
    assert!(
        (found / expected - 1.0).abs() < 0.04,
        "{found} for {expected}"
    );
}

/// Each kick J finally moves a block by J / γ.
fn kicks_in_a_viscous_fluid_move_blocks_alike_at_every_step<W: SpatialWorld>() {
    for rate in [0.3, 12.0] {
        let scene = Scene {
            agitation: kicks(0.02),
            ..fluid(None, Some(viscosity(rate)))
        };
        let displacements = [1, 16].map(|substeps| {
            let mut world: W = world(&scene, &settings(substeps), &vec![still(); 400]);
            pass(&mut world, 40);
            let before = states(&world);
            pass(&mut world, 1);
            let after = states(&world);
            let displacements = before.iter().zip(&after);
            let displacements: Vec<f64> = displacements
                .map(|(a, b)| (b.position - a.position).norm())
                .collect();
            displacements
        });
        let apart = displacements[0]
            .iter()
            .zip(&displacements[1])
            .map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        // Positions at a height of 100 block lengths have a resolution of 1e-5 in Rapier.
        assert!(apart < 1e-4, "{rate}: {apart}");
        let square: f64 = displacements[0]
            .iter()
            .map(|displacement| displacement * displacement)
            .sum();
        let found = (square / 400.0).sqrt();
        let estimated = speed(&scene).rms.unwrap();
        // 1,200 independent squares have a standard error of 2 %.
        assert!(
            (found / estimated - 1.0).abs() < 0.06,
            "{rate}: {found} for {estimated}"
        );
    }
}

fn a_turning_block_is_slowed_too<W: SpatialWorld>() {
    let start = moving(Vector3::zeros(), at(0.0, 0.3, 0.0));
    let viscosity = 0.002;
    let mut slow: W = world(&fluid(None, Some(viscosity)), &settings(2), &[start]);
    pass(&mut slow, 10);
    // Viscous: 8.07 eta a^3 divided by I = 1 / 6.
    let exact = 0.3 * (-8.07 * 6.0 * viscosity * 10.0_f64).exp();
    let spin = slow.state(0).spin.y;
    assert!((spin / exact - 1.0).abs() < 1e-5, "{spin} {exact}");
    let mut wake: W = world(&fluid(Some(0.9), None), &settings(2), &[start]);
    pass(&mut wake, 40);
    // Wake: rho / 32 divided by I = 1 / 6.
    let exact = 0.3 / (1.0 + 0.3 * 0.9 * 6.0 / 32.0 * 40.0);
    let spin = wake.state(0).spin.y;
    assert!((spin / exact - 1.0).abs() < 1e-5, "{spin} {exact}");
}

fn a_neutral_block_stays_on_its_circle_in_a_vortex<W: SpatialWorld>() {
    for (radius, distance) in [(5.0, 2.0), (1.5, 3.0)] {
        let mut scene = fluid(Some(1.0), Some(viscosity(0.3)));
        scene.flow = Some(Flow::Stir(Stir {
            radius,
            rate: 0.04,
            force: None,
            follow: 0.5,
        }));
        let turning = if distance < radius {
            0.02
        } else {
            0.02 * (radius / distance).powi(2)
        };
        let start = BodyState {
            velocity: at(0.0, turning * distance, 0.0),
            ..BodyState::at_rest(at(distance, 0.0, 50.0))
        };
        let mut world: W = world(&scene, &settings(4), &[start]);
        pass(&mut world, 1000);
        let block = world.state(0);
        let across = block.position.xy().norm();
        assert!(
            (across / distance - 1.0).abs() < 0.01,
            "{distance}: {across}"
        );
        let speed = block.velocity.norm() / (turning * distance);
        assert!((speed - 1.0).abs() < 0.01, "{speed}");
        // Inside the core the block turns with the fluid, outside it does not turn.
        let spin = if distance < radius { turning } else { 0.0 };
        assert!((block.spin.z - spin).abs() < 1e-4, "{}", block.spin);
    }
}

/// Returns `count` blocks at rest. They do not interact in these scenes.
fn many(count: usize) -> Vec<BodyState> {
    vec![BodyState::at_rest(at(0.0, 0.0, 0.0)); count]
}

/// Returns agitation whose k T is `energy`, in block units.
fn hot(energy: f64) -> Option<Agitation> {
    Some(Agitation::Brownian {
        temperature: energy / BOLTZMANN,
    })
}

fn brownian_blocks_diffuse_as_einstein_says_at_every_step<W: SpatialWorld>() {
    let count = 2000;
    for (rate, energy, substeps) in [
        (0.2, 1e-4, 1),
        (2.0, 1e-2, 1),
        (2.0, 1e-2, 4),
        (50.0, 1.0, 1),
    ] {
        let mut scene = fluid(None, Some(viscosity(rate)));
        scene.agitation = hot(energy);
        let mut world: W = world(&scene, &settings(substeps), &many(count));
        // Wait until the blocks have reached thermal speeds.
        pass(&mut world, 50);
        let start = states(&world);
        let ticks = 200;
        pass(&mut world, ticks);
        let end = states(&world);
        let squares = (end.iter().zip(&start))
            .map(|(end, start)| (end.position - start.position).norm_squared());
        let mean = squares.sum::<f64>() / count as f64;
        // <x^2> of the Ornstein-Uhlenbeck process: 6 D (t - (1 - exp(-rate t)) / rate).
        let (t, diffusion) = (ticks as f64, energy / rate);
        let exact = 6.0 * diffusion * (t - (1.0 - (-rate * t).exp()) / rate);
        // 6,000 independent squares have a standard error of 1.8 %; the limit is four of these. The
        // last term is at most 3 %.
        assert!(
            (mean / exact - 1.0).abs() < 0.075,
            "{rate} {substeps}: {mean} {exact}"
        );
    }
}

fn brownian_blocks_have_the_energy_of_their_temperature<W: SpatialWorld>() {
    let (count, energy) = (4000, 1e-4);
    let rate = 0.05;
    let mut scene = fluid(None, Some(viscosity(rate)));
    scene.agitation = hot(energy);
    let mut world: W = world(&scene, &settings(2), &many(count));
    pass(&mut world, 150);
    let (mut moving, mut turning) = (0.0, 0.0);
    for block in states(&world) {
        moving += block.velocity.norm_squared() / 3.0 / count as f64;
        turning += block.spin.norm_squared() / 6.0 / 3.0 / count as f64;
    }
    // 12,000 squares have a standard error of 1.3 %; the limit is four of these. Steps of rate dt =
    // 0.025 and 0.09 shift them by far less.
    assert!((moving / energy - 1.0).abs() < 0.052, "{moving}");
    assert!((turning / energy - 1.0).abs() < 0.052, "{turning}");
}

fn blocks_follow_eddies_and_disperse_as_taylor_says<W: SpatialWorld>() {
    // The viscosity carries a block with the fluid, and the memory is so short that it hardly
    // leaves its eddy. Then a position diffuses with sigma^2 times the memory.
    let (speed, memory, runs) = (0.02, 8.0, 400);
    let mut scene = fluid(None, Some(viscosity(40.0)));
    scene.agitation = Some(Agitation::Turbulence(Turbulence {
        strength: Strength::Speed(speed),
        length: 30.0,
        time: Some(memory),
        vertical: 0.5,
    }));
    let ticks = 240;
    let (mut level, mut upright) = (0.0, 0.0);
    for run in 0..runs {
        let start = [BodyState::at_rest(at(0.0, 0.0, 0.0))];
        let plate = crate::scenes::PLATE;
        let mut world =
            W::with_blocks(&scene, &plate, &settings(1), 7, run, &start).expect("a valid scene");
        pass(&mut world, ticks);
        let position = world.state(0).position;
        level += (position.x * position.x + position.y * position.y) / 2.0 / runs as f64;
        upright += position.z * position.z / runs as f64;
    }
    // Each tick an amplitude keeps exp(-1 / memory): the sum of a geometric series replaces the
    // integral.
    let left = (-1.0 / memory).exp();
    let t = ticks as f64;
    let steps =
        t * (1.0 + left) / (1.0 - left) - 2.0 * left * (1.0 - left.powf(t)) / (1.0 - left).powi(2);
    let exact = speed * speed * steps;
    // 800 squares have a standard error of 5 %, 400 squares of 7 %; the limits are four of these.
    assert!((level / exact - 1.0).abs() < 0.2, "{level} {exact}");
    assert!(
        (upright / exact / 0.25 - 1.0).abs() < 0.28,
        "{upright} {exact}"
    );
}

fn a_jet_carries_a_block_to_the_middle<W: SpatialWorld>() {
    let mut scene = fluid(None, Some(viscosity(20.0)));
    scene.enclosure = Some(Enclosure::Sphere {
        radius: 6.0,
        wall: 0.01,
    });
    let (flow, nozzle) = (0.02, 0.4);
    scene.flow = Some(Flow::Jets(Jets {
        count: 1,
        flow,
        nozzle,
    }));
    // Height of the centre of a sphere above a plate of 3 x 3.
    let height = (36.0_f64 - 4.5).sqrt();
    let from = 4.0;
    let mut world: W = world(
        &scene,
        &settings(8),
        &[BodyState::at_rest(at(from, 0.0, height))],
    );
    let ticks = 40;
    pass(&mut world, ticks);
    let x = world.state(0).position.x;
    // On the axis s s' = 6.2 D U, starting at the tube, 6 block lengths from the centre.
    let speed = flow / (std::f64::consts::FRAC_PI_4 * nozzle * nozzle);
    let distance = 6.0 - from;
    let exact = 6.0 - (distance * distance + 2.0 * 6.2 * nozzle * speed * ticks as f64).sqrt();
    assert!((x - exact).abs() < 0.03 * (from - exact), "{x} {exact}");
}

fn a_sphere_keeps_its_blocks<W: SpatialWorld>() {
    let wall = 0.01;
    let scene = Scene {
        enclosure: Some(Enclosure::Sphere { radius: 5.0, wall }),
        ..empty()
    };
    let height = (25.0_f64 - 4.5).sqrt();
    // A swing into the wall is half an oscillation, at the radius of 4.5 block lengths.
    for direction in [at(0.0, 0.0, 1.0), at(0.6, 0.0, -0.8), at(0.0, -1.0, 0.0)] {
        let start = BodyState {
            velocity: direction * 0.05,
            ..BodyState::at_rest(direction * 4.5 + Vector3::z() * height)
        };
        let mut world: W = world(&scene, &settings(16), &[start]);
        let half = std::f64::consts::PI / f64::sqrt(wall);
        pass(&mut world, half.round() as u64);
        let block = world.state(0);
        assert!(
            (block.velocity + start.velocity).norm() < 0.002,
            "{block:?}"
        );
        assert!((block.position - start.position).norm() < 0.05, "{block:?}");
    }
}
