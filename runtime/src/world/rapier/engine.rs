//! Setup of the engine: blocks, ground and contact settings.
use nalgebra::Vector3;
use rapier3d::dynamics::{
    IntegrationParameters, MassProperties, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::glamx::Vec3;
use rapier3d::pipeline::PhysicsWorld;
use stochc_ir::scene::ContactLaw;
use stochc_ir::table::Plate;

use super::convert::{pose3, vec3};
use crate::settings::Settings;
use crate::world::parameters::{ContactParameters, Wall, WorldParameters};
use crate::world::real::cast;
use crate::world::unit_cube::INVERSE_INERTIA;
use crate::world::{BodyState, SceneError};

/// Thickness of the ground \[block lengths\]. If the ground were thin, the engine would push blocks
/// out at its lower side.
const GROUND: f32 = 20.0;

/// Returns the engine's contact settings in block units.
///
/// They are the engine's defaults, meant for metres and seconds, at the scale of the paper's scene:
/// a block of 0.2 m and a tick of 0.02 s. Every scene thus has the contacts of `hemisphere_2005`,
/// which is calibrated with them. The allowed overlap and the prediction distance shrink with the
/// step. The recycling distance does not: contacts that moved by less than 0.25 block lengths are
/// reused at every step size.
fn contact_settings(settings: &Settings) -> IntegrationParameters {
    let softness = |natural_frequency| SpringCoefficients {
        natural_frequency,
        damping_ratio: 10.0,
    };
    let substeps = settings.substeps.max(1) as f32;
    IntegrationParameters {
        dt: 1.0 / substeps,
        contact_softness: softness(0.6),
        static_contact_softness: softness(1.2),
        length_unit: 1.0,
        normalized_allowed_linear_error: 0.025 / substeps,
        normalized_max_corrective_velocity: 0.3,
        normalized_prediction_distance: 0.1 / substeps,
        normalized_contact_recycle_distance: 0.25,
        // Excessive speed must be reported as a fault, not clamped.
        normalized_max_linear_velocity: f32::MAX,
        num_solver_iterations: settings.iterations() as usize,
        max_ccd_substeps: 0,
        ..IntegrationParameters::default()
    }
}

/// Returns an engine with ground and blocks, and the handles of the blocks by number.
pub(super) fn engine(
    parameters: &WorldParameters,
    contact: Option<Surface>,
    plate: &Plate,
    settings: &Settings,
    blocks: &[BodyState],
) -> (Box<PhysicsWorld>, Vec<RigidBodyHandle>) {
    let mut engine = Box::new(PhysicsWorld {
        gravity: Vec3::ZERO,
        integration_parameters: contact_settings(settings),
        ..PhysicsWorld::default()
    });
    if let Some(contact) = contact
        && !parameters.is_planar
    {
        let ground = ground(parameters.wall, plate);
        engine.insert(
            RigidBodyBuilder::fixed().translation(Vec3::new(0.0, 0.0, -ground.z)),
            contact.apply(ColliderBuilder::cuboid(ground.x, ground.y, ground.z)),
        );
    }
    let handles = blocks.iter().map(|state| {
        let block = RigidBodyBuilder::dynamic()
            .pose(pose3(cast(state.position), state.orientation.cast()))
            .linvel(vec3(cast(state.velocity)))
            .angvel(vec3(cast(state.spin)))
            .enabled_translations(true, true, !parameters.is_planar)
            .enabled_rotations(!parameters.is_planar, !parameters.is_planar, true)
            .can_sleep(false)
            // The inertia of a cube is isotropic.
            .gyroscopic_forces_enabled(false)
            .allow_fast_rotation(true);
        match contact {
            Some(contact) => {
                let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5).density(1.0);
                engine.insert(block, contact.apply(cube)).0
            }
            None => {
                let inertia = Vec3::splat(1.0 / INVERSE_INERTIA as f32);
                let mass = MassProperties::new(Vec3::ZERO, 1.0, inertia);
                engine.bodies.insert(block.additional_mass_properties(mass))
            }
        }
    });
    let handles = handles.collect();
    (engine, handles)
}

/// Adds the seeds of a planar world as immovable blocks.
pub(super) fn add_seeds(engine: &mut PhysicsWorld, contact: Surface, centres: &[Vector3<f32>]) {
    for &centre in centres {
        engine.insert(
            RigidBodyBuilder::fixed().translation(vec3(centre)),
            contact.apply(ColliderBuilder::cuboid(0.5, 0.5, 0.5)),
        );
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    restitution: f32,
    friction: f32,
}

/// Returns the contact properties of the engine's bodies.
///
/// # Errors
///
/// If contacts have a compliant law, because the engine's solver determines the compliance of
/// contacts.
pub(super) fn surface(contact: &ContactParameters) -> Result<Surface, SceneError> {
    match contact.law {
        ContactLaw::Rigid { restitution } => Ok(Surface {
            restitution: restitution as f32,
            friction: contact.friction as f32,
        }),
        ContactLaw::Compliant { .. } => Err(SceneError::NotInModel {
            what: "contact with a `stiffness`",
            model: "rapier",
            instead: "rigid",
        }),
    }
}

impl Surface {
    fn apply(self, collider: ColliderBuilder) -> ColliderBuilder {
        collider
            .friction(self.friction)
            .restitution(self.restitution)
    }
}

/// Returns the distance from the plate within which every block has ground below it \[block
/// lengths\].
pub(super) fn ground_reach(radius: f64) -> f64 {
    2.0 * radius + 9.0
}

/// Returns half the size of the ground, whose upper side is level with the plate at z = 0.
///
/// The ground is a slab, because an infinite plane would be tested against every block in every
/// step. It extends as far as the wall lets blocks move. Without an enclosure there is only the
/// plate.
fn ground(wall: Option<Wall>, plate: &Plate) -> Vector3<f32> {
    match wall {
        Some(wall) => {
            let half = ground_reach(wall.interior.reach()) as f32 + 1.0;
            Vector3::new(half, half, GROUND / 2.0)
        }
        None => Vector3::new(plate.width as f32 / 2.0, plate.depth as f32 / 2.0, 0.5),
    }
}
