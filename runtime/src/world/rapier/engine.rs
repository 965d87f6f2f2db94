//! Sets the engine up: blocks, ground, and how contacts are solved.
use nalgebra::Vector3;
use rapier3d::dynamics::{
    IntegrationParameters, MassProperties, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::glamx::{Pose3, Vec3};
use rapier3d::pipeline::PhysicsWorld;
use stochc_compiler::table::Plate;

use super::convert::{quat, vec3};
use super::magnet::INVERSE_INERTIA;
use super::terms::{Contact, Hemisphere, Terms};
use super::{BodyState, INSIDE};
use crate::settings::Settings;

/// Thickness of the ground \[side\]: so much that nothing is ever pushed out below it.
const GROUND: f32 = 20.0;

/// The engine's contact settings in block units.
///
/// They are the engine's defaults, which are meant for metres and seconds, read at the scale of
/// the paper's scene: a side of 0.2 m and a tick of 0.02 s. So every scene, at whichever scale, has
/// the contacts with which `hemisphere` is calibrated.
fn parameters(settings: &Settings) -> IntegrationParameters {
    let softness = |natural_frequency| SpringCoefficients {
        natural_frequency,
        damping_ratio: 10.0,
    };
    IntegrationParameters {
        dt: 1.0 / settings.substeps.max(1) as f32,
        contact_softness: softness(0.6),
        static_contact_softness: softness(1.2),
        length_unit: 1.0,
        normalized_allowed_linear_error: 0.025,
        normalized_max_corrective_velocity: 0.3,
        normalized_prediction_distance: 0.1,
        normalized_contact_recycle_distance: 0.25,
        // Too fast is a fault, not something to hide.
        normalized_max_linear_velocity: f32::MAX,
        num_solver_iterations: settings.solver_iterations.max(1) as usize,
        max_ccd_substeps: 0,
        ..IntegrationParameters::default()
    }
}

/// An engine with ground and blocks, and the handles of the blocks by their numbers.
pub(super) fn engine(
    terms: &Terms,
    plate: &Plate,
    settings: &Settings,
    blocks: &[BodyState],
) -> (Box<PhysicsWorld>, Vec<RigidBodyHandle>) {
    let mut engine = Box::new(PhysicsWorld {
        gravity: Vec3::ZERO,
        integration_parameters: parameters(settings),
        ..PhysicsWorld::default()
    });
    if let Some(contact) = terms.contact {
        let ground = ground(terms.hemisphere, plate);
        engine.insert(
            RigidBodyBuilder::fixed().translation(Vec3::new(0.0, 0.0, -ground.z)),
            surface(
                ColliderBuilder::cuboid(ground.x, ground.y, ground.z),
                contact,
            ),
        );
    }
    let handles = blocks.iter().map(|state| {
        let block = RigidBodyBuilder::dynamic()
            .pose(pose(state))
            .linvel(vec3(state.velocity))
            .angvel(vec3(state.spin))
            .can_sleep(false)
            // A cube's inertia is the same about all axes.
            .gyroscopic_forces_enabled(false)
            .allow_fast_rotation(true);
        match terms.contact {
            Some(contact) => {
                let half = INSIDE;
                let cube = ColliderBuilder::cuboid(half, half, half).density(1.0);
                engine.insert(block, surface(cube, contact)).0
            }
            None => {
                let inertia = Vec3::splat(1.0 / INVERSE_INERTIA);
                let mass = MassProperties::new(Vec3::ZERO, 1.0, inertia);
                engine.bodies.insert(block.additional_mass_properties(mass))
            }
        }
    });
    let handles = handles.collect();
    (engine, handles)
}

fn surface(collider: ColliderBuilder, contact: Contact) -> ColliderBuilder {
    collider
        .friction(contact.friction)
        .restitution(contact.restitution)
}

/// Half the size of the ground, whose upper side is z = 0 and level with the plate.
///
/// A slab, because an endless plane would meet every block in every step. It reaches as far as
/// the shell lets blocks go. Without an enclosure there is no floor, only the plate.
fn ground(hemisphere: Option<Hemisphere>, plate: &Plate) -> Vector3<f32> {
    match hemisphere {
        Some(Hemisphere { radius, .. }) => {
            let half = 2.0 * radius + 10.0;
            Vector3::new(half, half, GROUND / 2.0)
        }
        None => Vector3::new(plate.width as f32 / 2.0, plate.depth as f32 / 2.0, 0.5),
    }
}

/// The pose of a block.
pub(super) fn pose(state: &BodyState) -> Pose3 {
    Pose3::from_parts(vec3(state.position), quat(state.orientation))
}
