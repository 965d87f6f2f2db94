//! Rapier with two sets of settings, without code of the project.
use std::error::Error;

use rapier3d::dynamics::{
    IntegrationParameters, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::glamx::Vec3;
use rapier3d::pipeline::PhysicsWorld;

use crate::drive::{Gas, State};
use crate::scene::{FRICTION, Push, radius, start};

/// Thickness of the ground \[block lengths\].
const GROUND: f32 = 20.0;

pub struct Rapier {
    tick: u64,
    push: Push,
    engine: PhysicsWorld,
    handles: Vec<RigidBodyHandle>,
    /// Length of a block in the unit of the engine.
    side: f32,
    /// One block length per tick in the unit of the engine.
    speed: f32,
    /// Whether the engine may deactivate resting blocks.
    sleep: bool,
}

impl Rapier {
    /// Returns Rapier with its default settings in the units they are meant for, metres and
    /// seconds. A block has 0.2 m, a tick 0.02 s.
    pub fn defaults(blocks: u32, kick: f64) -> Rapier {
        let parameters = IntegrationParameters {
            dt: 0.02,
            ..IntegrationParameters::default()
        };
        Rapier::new(blocks, kick, parameters, 0.2, true)
    }

    /// Returns Rapier with the settings of `runtime/src/world/rapier/engine.rs`, in block units.
    /// The contacts are the same. There is no continuous collision detection, no speed limit, and
    /// no deactivation of resting blocks.
    pub fn as_the_project(blocks: u32, kick: f64) -> Rapier {
        let softness = |natural_frequency| SpringCoefficients {
            natural_frequency,
            damping_ratio: 10.0,
        };
        let parameters = IntegrationParameters {
            dt: 1.0,
            contact_softness: softness(0.6),
            static_contact_softness: softness(1.2),
            length_unit: 1.0,
            normalized_allowed_linear_error: 0.025,
            normalized_max_corrective_velocity: 0.3,
            normalized_prediction_distance: 0.1,
            normalized_contact_recycle_distance: 0.25,
            normalized_max_linear_velocity: f32::MAX,
            num_solver_iterations: 4,
            max_ccd_substeps: 0,
            ..IntegrationParameters::default()
        };
        Rapier::new(blocks, kick, parameters, 1.0, false)
    }

    fn new(
        blocks: u32,
        kick: f64,
        parameters: IntegrationParameters,
        side: f32,
        sleep: bool,
    ) -> Rapier {
        let mut engine = PhysicsWorld {
            gravity: Vec3::ZERO,
            integration_parameters: parameters,
            ..PhysicsWorld::default()
        };
        let surface = |collider: ColliderBuilder| collider.friction(FRICTION).restitution(0.0);
        // The ground is a slab, because an infinite plane would be tested against every block in
        // every step.
        let half = side * (2.0 * radius(blocks) as f32 + 10.0);
        let below = side * GROUND / 2.0;
        engine.insert(
            RigidBodyBuilder::fixed().translation(Vec3::new(0.0, 0.0, -below)),
            surface(ColliderBuilder::cuboid(half, half, below)),
        );
        let handles = start(blocks).into_iter().map(|position| {
            let mut block = RigidBodyBuilder::dynamic()
                .translation(Vec3::from(position.map(|x| x as f32)) * side);
            if !sleep {
                block = block
                    .can_sleep(false)
                    .gyroscopic_forces_enabled(false)
                    .allow_fast_rotation(true);
            }
            let cube = ColliderBuilder::cuboid(side / 2.0, side / 2.0, side / 2.0).mass(1.0);
            engine.insert(block, surface(cube)).0
        });
        let handles = handles.collect();
        Rapier {
            tick: 0,
            push: Push::new(blocks, kick),
            side,
            speed: side / parameters.dt,
            engine,
            handles,
            sleep,
        }
    }
}

impl Gas for Rapier {
    fn tick(&mut self) -> Result<(), Box<dyn Error>> {
        for (id, &handle) in self.handles.iter().enumerate() {
            let body = &mut self.engine.bodies[handle];
            let position = body.translation() / self.side;
            let velocity = body.linvel() / self.speed;
            let velocity = self.push.apply(self.tick, id as u32, position, velocity);
            body.set_linvel(velocity * self.speed, self.sleep);
        }
        self.engine.step();
        self.tick += 1;
        Ok(())
    }

    fn states(&self) -> Vec<State> {
        let bodies = self.handles.iter().map(|&handle| {
            let body = &self.engine.bodies[handle];
            State {
                position: (body.translation() / self.side).to_array().map(f64::from),
                velocity: (body.linvel() / self.speed).to_array().map(f64::from),
                rotation: body.rotation().to_array().map(f64::from),
            }
        });
        bodies.collect()
    }

    fn contacts(&self) -> Option<usize> {
        let manifolds = self
            .engine
            .narrow_phase
            .contact_pairs()
            .flat_map(|pair| pair.manifolds());
        Some(manifolds.map(|it| it.data.solver_contacts.len()).sum())
    }

    fn kicks(&self) -> Option<f64> {
        Some(self.push.digest())
    }
}
