//! Motion and collisions of blocks by the engine.
use nalgebra::Vector3;
use stochc_ir::state::State;
use stochc_ir::table::Plate;

use super::bodies::EngineBodies;
use super::engine::{Surface, add_seeds, engine, ground_reach, surface};
use super::joints::Joints;
use crate::counter_rng::{StepDraws, direction, unit};
use crate::settings::{Precision, Settings};
use crate::world::blocks::Blocks;
use crate::world::free_bonds::FreeBonds;
use crate::world::motion_limits::MotionLimits;
use crate::world::parameters::{Kicks, WorldParameters};
use crate::world::stepper::{Integrator, Moving};
use crate::world::wall_force::WallForce;
use crate::world::{BodyState, Fault, SceneError};

/// The engine as an integrator.
pub(super) struct Rapier {
    wall: Option<WallForce<f32>>,
    /// Fraction of the velocity that linear drag leaves in each substep.
    drag: Option<f32>,
    /// Length of a substep \[tick\].
    dt: f32,
    joints: Joints,
    limits: MotionLimits,
    contact: Option<Surface>,
    /// Whether blocks move only in a horizontal plane.
    is_planar: bool,
}

/// No method is implemented, as for [`EngineBodies`].
impl State for Rapier {}

impl Integrator for Rapier {
    type Real = f32;
    type Blocks = EngineBodies;

    fn new(
        parameters: &WorldParameters,
        plate: &Plate,
        settings: &Settings,
        blocks: &[BodyState],
    ) -> Result<(EngineBodies, Rapier), SceneError> {
        let cannot = |what| SceneError::NotInModel {
            what,
            model: "rapier",
            instead: "rigid",
        };
        if settings.precision == Precision::Double {
            return Err(cannot("double precision"));
        }
        if settings.reduction.is_some() {
            return Err(cannot("term that can be left out"));
        }
        let contact = parameters.contact.as_ref().map(surface).transpose()?;
        let (engine, handles) = engine(parameters, contact, plate, settings, blocks);
        let substeps = settings.substeps.max(1);
        let limits = MotionLimits::new(substeps, parameters.contact.is_some());
        let limits = match (&parameters.contact, parameters.wall) {
            (Some(_), Some(wall)) if !parameters.is_planar => {
                limits.within(ground_reach(wall.interior.reach()))
            }
            _ => limits,
        };
        let left = |rate: f64| libm::exp(-rate / f64::from(substeps)) as f32;
        let rapier = Rapier {
            wall: parameters.wall.as_ref().map(WallForce::new),
            drag: parameters.drag.map(left),
            dt: 1.0 / substeps as f32,
            joints: Joints::default(),
            limits,
            contact,
            is_planar: parameters.is_planar,
        };
        Ok((EngineBodies::new(engine, handles, blocks), rapier))
    }

    /// Lists all blocks: selecting the near ones would cost as much as it saves.
    fn near(&self, bodies: &EngineBodies, _place: Vector3<f32>, _reach: f32, found: &mut Vec<u32>) {
        found.clear();
        found.extend(0..bodies.count());
    }

    fn advance(
        &mut self,
        bodies: &mut EngineBodies,
        mut kicks: Option<(&Kicks, StepDraws<'_>)>,
        bonds: Option<&mut FreeBonds>,
        _who: Moving,
    ) -> Result<(), Fault> {
        if let Some(bonds) = bonds {
            self.joints.follow(bodies, bonds.groups.bonds());
        }
        for id in 0..bodies.copies.len() {
            let block = &mut bodies.copies[id];
            if block.anchored.is_some() {
                continue;
            }
            let pull = self.wall.and_then(|wall| wall.pull(block.position));
            if let Some((displacement, pull)) = pull {
                block.velocity -= displacement * (pull * self.dt);
            }
            if let Some((Kicks { speed: (low, high) }, step)) = &mut kicks {
                let [speed, height, azimuth, _] = step.block(id as u32);
                let speed = (low + (high - low) * unit(speed)) as f32;
                let direction = if self.is_planar {
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit(azimuth));
                    Vector3::new(cos as f32, sin as f32, 0.0)
                } else {
                    Vector3::from(direction(height, azimuth))
                };
                block.velocity += speed * direction;
            }
            if let Some(factor) = self.drag {
                block.velocity *= factor;
            }
            bodies.show_velocity(id);
        }
        bodies.engine.step();
        bodies.read(&self.limits)
    }

    fn place_seeds(&mut self, bodies: &mut EngineBodies, centres: &[Vector3<f32>]) {
        if let Some(contact) = self.contact {
            add_seeds(&mut bodies.engine, contact, centres);
        }
    }

    fn joined(&mut self, bodies: &mut EngineBodies, bonds: &FreeBonds) {
        bodies.show_moved();
        self.joints.follow(bodies, bonds.groups.bonds());
    }
}
