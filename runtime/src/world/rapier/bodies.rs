//! Bodies of the engine, and a copy of their state.
use nalgebra::{UnitQuaternion, Vector3};
use rapier3d::dynamics::{RigidBodyHandle, RigidBodyType};
use rapier3d::glamx::Vec3;
use rapier3d::pipeline::PhysicsWorld;
use stochc_control::Orientation;
use stochc_ir::state::State;

use super::convert::{pose3, unit_quaternion, vec3, vector};
use crate::world::blocks::{Blocks, Pose};
use crate::world::motion_limits::MotionLimits;
use crate::world::real::{Real, cast};
use crate::world::rotation::quaternion;
use crate::world::{BodyState, Fault};

/// Blocks by number. Their state is copied from the engine once per substep.
pub(crate) struct EngineBodies {
    pub(super) engine: Box<PhysicsWorld>,
    pub(super) handles: Vec<RigidBodyHandle>,
    pub(super) copies: Vec<Copied>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Copied {
    pub position: Vector3<f32>,
    rotation: UnitQuaternion<f32>,
    pub velocity: Vector3<f32>,
    spin: Vector3<f32>,
    /// Orientation in the structure. `None` if the block is free.
    pub anchored: Option<Orientation>,
    /// Whether the engine's position is out of date.
    moved: bool,
}

impl Copied {
    fn free(state: &BodyState) -> Copied {
        Copied {
            position: cast(state.position),
            rotation: state.orientation.cast(),
            velocity: cast(state.velocity),
            spin: cast(state.spin),
            anchored: None,
            moved: false,
        }
    }
}

/// No method is implemented: the engine would restore its state without validation.
impl State for EngineBodies {}

impl EngineBodies {
    pub fn new(
        engine: Box<PhysicsWorld>,
        handles: Vec<RigidBodyHandle>,
        blocks: &[BodyState],
    ) -> EngineBodies {
        let copies = blocks.iter().map(Copied::free).collect();
        EngineBodies {
            engine,
            handles,
            copies,
        }
    }

    /// Writes the velocity of a block to the engine if it has changed. Every write makes the engine
    /// process the block.
    pub fn show_velocity(&mut self, id: usize) {
        let (block, handle) = (&self.copies[id], self.handles[id]);
        let known = &self.engine.bodies[handle];
        let (linear, angular) = (vector(known.linvel()), vector(known.angvel()));
        if linear != block.velocity || angular != block.spin {
            let body = &mut self.engine.bodies[handle];
            body.set_linvel(vec3(block.velocity), false);
            body.set_angvel(vec3(block.spin), false);
        }
    }

    /// Writes the positions of blocks that were moved outside the engine.
    pub fn show_moved(&mut self) {
        for (block, &handle) in self.copies.iter_mut().zip(&self.handles) {
            if std::mem::take(&mut block.moved) {
                let pose = pose3(block.position, block.rotation);
                self.engine.bodies[handle].set_position(pose, false);
            }
        }
    }

    /// Reads the state of the free blocks from the engine.
    ///
    /// # Errors
    ///
    /// If a value is invalid.
    pub fn read(&mut self, limits: &MotionLimits) -> Result<(), Fault> {
        let quarantine = self.engine.physics_pipeline.quarantine();
        if !quarantine.is_empty() {
            let lost = |handle| quarantine.bodies().contains(handle);
            let body = self.handles.iter().position(lost).unwrap_or(0) as u32;
            let what = "its position or speed is not a number".to_owned();
            return Err(Fault { body, what });
        }
        for (id, (block, &handle)) in (0..).zip(self.copies.iter_mut().zip(&self.handles)) {
            if block.anchored.is_some() {
                continue;
            }
            let body = &self.engine.bodies[handle];
            block.position = vector(body.translation());
            block.rotation = unit_quaternion(*body.rotation());
            block.velocity = vector(body.linvel());
            block.spin = vector(body.angvel());
            let motion = [block.position, block.velocity, block.spin];
            limits.check(id, motion, &block.rotation)?;
        }
        Ok(())
    }
}

impl Blocks for EngineBodies {
    type Real = f32;

    fn count(&self) -> u32 {
        self.copies.len() as u32
    }

    fn anchored(&self, id: u32) -> Option<Orientation> {
        self.copies[id as usize].anchored
    }

    fn position(&self, id: u32) -> Vector3<f32> {
        self.copies[id as usize].position
    }

    fn velocity(&self, id: u32) -> Vector3<f32> {
        self.copies[id as usize].velocity
    }

    fn spin(&self, id: u32) -> Vector3<f32> {
        self.copies[id as usize].spin
    }

    fn rotation(&mut self, id: u32) -> UnitQuaternion<f32> {
        self.copies[id as usize].rotation
    }

    fn state(&self, id: u32) -> BodyState {
        let block = &self.copies[id as usize];
        let rotation = block.rotation.coords.map(Real::double);
        BodyState {
            position: cast(block.position),
            orientation: UnitQuaternion::from_quaternion(rotation.into()),
            velocity: cast(block.velocity),
            spin: cast(block.spin),
        }
    }

    fn set_state(&mut self, id: u32, state: &BodyState) {
        let block = Copied::free(state);
        self.copies[id as usize] = block;
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_position(pose3(block.position, block.rotation), false);
        body.set_linvel(vec3(block.velocity), false);
        body.set_angvel(vec3(block.spin), false);
    }

    fn set_pose(&mut self, id: u32, pose: &Pose) {
        let block = &mut self.copies[id as usize];
        (block.position, block.rotation) = (cast(pose.position), pose.rotation.cast());
        block.moved = true;
    }

    fn set_velocity(&mut self, id: u32, velocity: Vector3<f32>, spin: Vector3<f32>) {
        let block = &mut self.copies[id as usize];
        (block.velocity, block.spin) = (velocity, spin);
    }

    fn anchor(&mut self, id: u32, centre: Vector3<f32>, orientation: Orientation) {
        let rotation = quaternion(orientation).cast();
        self.copies[id as usize] = Copied {
            position: centre,
            rotation,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            anchored: Some(orientation),
            moved: false,
        };
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_body_type(RigidBodyType::Fixed, false);
        body.set_position(pose3(centre, rotation), false);
    }

    fn release(&mut self, id: u32) {
        let block = &mut self.copies[id as usize];
        (block.anchored, block.velocity) = (None, Vector3::zeros());
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_body_type(RigidBodyType::Dynamic, false);
        body.set_linvel(Vec3::ZERO, false);
        body.set_angvel(Vec3::ZERO, false);
    }
}
