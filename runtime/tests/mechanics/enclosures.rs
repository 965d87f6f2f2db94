//! Compares walls with closed forms: collision rates, densities, springs and the start.
use std::f64::consts::PI;

use crate::scenes::{Dice, PLATE, at, contact, empty, in_steps, kicks, moving, pass, states};
use nalgebra::Vector3;
use stochc_ir::scene::dimensionless::BlockUnits;
use stochc_ir::scene::{Arrangement, Drag, Enclosure, Free, Interior, Scene};
use stochc_runtime::world::SpatialWorld;
use stochc_runtime::{Model, Settings};

in_every_world!(
    a_gas_hits_walls_as_often_as_kinetic_theory_says,
    a_wall_is_a_spring_along_its_normal,
    a_lid_holds_lighter_blocks,
    blocks_fill_tanks_of_every_size,
);

const WALL: f64 = 1.0;

fn enclosures() -> [Enclosure; 4] {
    let (radius, height, wall) = (4.0, 5.0, WALL);
    [
        Enclosure::Sphere { radius, wall },
        Enclosure::Box {
            length: 7.0,
            width: 5.0,
            height,
            wall,
        },
        Enclosure::Cylinder {
            radius,
            height,
            wall,
        },
        // A disc.
        Enclosure::Cylinder {
            radius: 8.0,
            height: 2.0,
            wall,
        },
    ]
}

fn tank(enclosure: &Enclosure) -> Scene {
    Scene {
        enclosure: Some(enclosure.clone()),
        ..empty()
    }
}

fn interior(enclosure: &Enclosure) -> Interior {
    enclosure.interior(&PLATE, BlockUnits::from_scene(&tank(enclosure)))
}

/// Returns the volume and the area of a region.
fn measures(interior: Interior) -> (f64, f64) {
    match interior {
        Interior::Ball { radius, .. } => {
            (4.0 / 3.0 * PI * radius.powi(3), 4.0 * PI * radius.powi(2))
        }
        Interior::Box { half, low, high } => {
            let [x, y, z] = [2.0 * half[0], 2.0 * half[1], high - low];
            (x * y * z, 2.0 * (x * y + y * z + z * x))
        }
        Interior::Cylinder { radius, low, high } => {
            let floor = PI * radius * radius;
            (
                floor * (high - low),
                2.0 * floor + 2.0 * PI * radius * (high - low),
            )
        }
    }
}

/// Returns whether a position is beyond each of the walls.
fn walls(interior: Interior, position: Vector3<f64>) -> Vec<bool> {
    let vertical = |low: f64, high: f64| [position.z < low, position.z > high];
    match interior {
        Interior::Ball { .. } => vec![interior.distance(position.into()) > 0.0],
        Interior::Box { half, low, high } => {
            let sides = [position.x.abs() > half[0], position.y.abs() > half[1]];
            [sides, vertical(low, high)].concat()
        }
        Interior::Cylinder { radius, low, high } => {
            let mut walls = vertical(low, high).to_vec();
            walls.push(position.x.hypot(position.y) > radius);
            walls
        }
    }
}

/// Blocks of one speed v without contacts hit walls n v A / 4 times per tick, n = N / V. Their
/// density stays uniform.
fn a_gas_hits_walls_as_often_as_kinetic_theory_says<W: SpatialWorld>() {
    let (speed, blocks, ticks) = (0.02, 1000, 600);
    for enclosure in enclosures() {
        let interior = interior(&enclosure);
        let mut dice = Dice::new(7);
        let mut gas = Vec::new();
        let reach = interior.reach();
        while gas.len() < blocks {
            let mut along = || reach * (2.0 * dice.unit() - 1.0);
            let position = at(along(), along(), along());
            if interior.distance(position.into()) < 0.0 {
                gas.push(moving(position, speed * dice.direction()));
            }
        }
        let mut world: W = in_steps(&tank(&enclosure), &gas);
        let mut before: Vec<Vec<bool>> = gas.iter().map(|b| walls(interior, b.position)).collect();
        let mut hits = 0;
        let mut deep = 0.0;
        // A quarter of the volume of the region is nearer to the wall than this.
        let (volume, area) = measures(interior);
        let mut margin = 0.25 * volume / area;
        for _ in 0..50 {
            margin *= 0.25 / (1.0 - measures(interior.shrunk(margin)).0 / volume);
        }
        for _ in 0..ticks {
            pass(&mut world, 1);
            for (block, before) in states(&world).iter().zip(&mut before) {
                let now = walls(interior, block.position);
                hits += now
                    .iter()
                    .zip(&*before)
                    .filter(|(now, before)| **now && !**before)
                    .count();
                let depth = interior.distance(block.position.into());
                deep += f64::from(u32::from(depth < -margin)) / f64::from(ticks);
                *before = now;
            }
        }
        let (hits, count) = (hits as f64, blocks as f64);
        let expected = count * speed * area / (4.0 * volume) * f64::from(ticks);
        // A hit takes half of a period of the spring. During this time, a block cannot hit again.
        let lost = hits * PI / WALL.sqrt() / (count * f64::from(ticks));
        let found = hits / (1.0 - lost);
        let error = 4.0 / expected.sqrt();
        assert!(
            (found / expected - 1.0).abs() < error,
            "{enclosure:?}: {found} {expected}"
        );
        let share = deep / count / (1.0 - lost);
        let error = 4.0 * (0.75 * 0.25 / count).sqrt();
        assert!((share - 0.75).abs() < error, "{enclosure:?}: {share}");
        // Springs store a part of the energy.
        let energy = states(&world).into_iter().map(|block| {
            let depth = interior.distance(block.position.into()).max(0.0);
            block.velocity.norm_squared() + WALL * depth * depth
        });
        let energy = energy.sum::<f64>();
        assert!(
            (energy / (count * speed * speed) - 1.0).abs() < 0.01,
            "{enclosure:?}"
        );
    }
}

/// A block that runs against a wall comes back with the same speed after half a period.
fn a_wall_is_a_spring_along_its_normal<W: SpatialWorld>() {
    let speed = 0.1;
    let (tall, wall) = (100.0, WALL);
    let (length, width, height, radius) = (8.0, 6.0, tall, 4.0);
    let flat = Enclosure::Box {
        length,
        width,
        height,
        wall,
    };
    let tube = Enclosure::Cylinder {
        radius,
        height,
        wall,
    };
    let diagonal = at(0.6, 0.8, 0.0);
    for (enclosure, normal, limit) in [
        (&flat, Vector3::x(), 3.5),
        (&flat, -Vector3::x(), 3.5),
        (&flat, Vector3::y(), 2.5),
        (&flat, Vector3::z(), 99.5 - 50.0),
        (&flat, -Vector3::z(), 50.0 - 0.5),
        (&tube, diagonal, 3.5),
        (&tube, -diagonal, 3.5),
        (&tube, Vector3::z(), 99.5 - 50.0),
    ] {
        let along = normal.cross(&at(0.3, -0.2, 0.9)).normalize() * 0.05;
        let tangent = if matches!(enclosure, Enclosure::Cylinder { .. }) && normal.z == 0.0 {
            at(0.0, 0.0, 0.05)
        } else {
            along
        };
        let start = at(0.0, 0.0, 50.0) + normal * (limit - 0.1);
        let block = moving(start, normal * speed + tangent);
        let settings = Settings::new(Model::Rapier, 64);
        let mut world: W = crate::scenes::world(&tank(enclosure), &settings, &[block]);
        // One tick to the wall, half a period in it, and one tick back.
        let (mut deepest, half) = (0.0_f64, PI / WALL.sqrt());
        for _ in 0..5 {
            pass(&mut world, 1);
            let out = (world.state(0).position - at(0.0, 0.0, 50.0)).dot(&normal) - limit;
            deepest = deepest.max(out);
        }
        let end = world.state(0);
        let expected = block.velocity - 2.0 * speed * normal;
        assert!(
            (end.velocity - expected).norm() < 0.002,
            "{enclosure:?} {normal}: {end:?}"
        );
        let expected = start + tangent * 5.0 + normal * (0.1 - speed * (5.0 - 1.0 - half));
        assert!(
            (end.position - expected).norm() < 0.005,
            "{enclosure:?} {normal}: {end:?}"
        );
        // The amplitude of the spring is v / sqrt(k). Samples are a tick apart.
        assert!(deepest < speed * 1.01 && deepest > 0.8 * speed, "{deepest}");
    }
}

/// Buoyancy presses blocks against the lid: they come to rest where the spring carries them.
fn a_lid_holds_lighter_blocks<W: SpatialWorld>() {
    for enclosure in enclosures() {
        let scene = Scene {
            // A quarter of the weight of the displaced fluid carries the block.
            gravity: Some(0.001),
            fluid: Some(stochc_ir::scene::Fluid {
                density: Some(2.0),
                viscosity: Some(crate::scenes::viscosity(0.5)),
                added_mass: None,
            }),
            ..tank(&enclosure)
        };
        let mut world: W = in_steps(&scene, &[moving(at(0.0, 0.0, 1.0), Vector3::zeros())]);
        pass(&mut world, 6000);
        let top = match interior(&enclosure) {
            Interior::Ball { radius, height } => radius + height,
            Interior::Box { high, .. } | Interior::Cylinder { high, .. } => high,
        };
        let height = world.state(0).position.z;
        assert!(
            (height - top - 0.001 / WALL).abs() < 2e-4,
            "{enclosure:?}: {height} {top}"
        );
    }
}

/// Tanks between a few blocks and the largest size are filled, and their blocks stay inside.
fn blocks_fill_tanks_of_every_size<W: SpatialWorld>() {
    for (size, count) in [(3.6, 1), (6.0, 10), (40.0, 300), (2e4, 300)] {
        let [_, tanks @ ..] = enclosures();
        for mut enclosure in tanks {
            for (name, length) in enclosure.lengths_mut() {
                let flat = name == "height" && *length < 3.0 && size < 1e3;
                let part = if name == "radius" { 0.5 } else { 1.0 };
                *length = if flat { 2.5 } else { part * size };
            }
            let scene = Scene {
                free: Free {
                    count,
                    arrangement: Arrangement::Uniform,
                },
                agitation: kicks(0.05),
                drag: Some(Drag { rate: 0.1 }),
                contact: contact(0.0, 0.2),
                ..tank(&enclosure)
            };
            let interior = interior(&enclosure);
            let mut world = W::new(&scene, &PLATE, &Settings::new(Model::Rapier, 4), 1, 0)
                .unwrap_or_else(|error| panic!("{enclosure:?}, {count}: {error}"));
            let start = states(&world);
            assert_eq!(start.len(), count as usize);
            for (i, one) in start.iter().enumerate() {
                let distance = interior.distance(one.position.into());
                assert!(distance <= -0.4999, "{enclosure:?} {distance}");
                let apart = |b: &&stochc_runtime::world::BodyState| {
                    (b.position - one.position).norm() < 1.09
                };
                assert_eq!(start[..i].iter().find(apart), None, "{enclosure:?}");
            }
            pass(&mut world, 200);
            for block in states(&world) {
                let distance = interior.distance(block.position.into());
                assert!(distance < 1.0, "{enclosure:?}: {distance}");
                assert!(block.position.z > 0.4, "{enclosure:?}: {}", block.position);
            }
        }
    }
}
