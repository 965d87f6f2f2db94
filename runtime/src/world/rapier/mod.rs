//! Full rigid bodies by the engine Rapier: the reference model.
//!
//! All cubes with rotation, contacts and friction, in single precision. A fluid
//! acts on each block alone: none feels its neighbours' wakes. Contacts are as soft as the
//! engine makes them, and with one substep a tick that is soft: see [`Settings`].
//!
//! Inside and in [`BodyState`], everything is in block units: the side of a block is 1, its mass 1,
//! the tick 1. The origin is the centre of the plate's upper side; z is up.
//!
//! A substep first changes velocities (magnets, shell, kicks, drag, in this order), then lets the
//! engine solve contacts and move the blocks, then looks who docked. As positions move with the
//! velocities just changed, this is the symplectic Euler method.
mod convert;
mod engine;
mod fault;
mod joints;
mod push;

use convert::{quat, vec3};
use joints::Joints;
use nalgebra::{UnitQuaternion, Vector3};
use rapier3d::dynamics::{RigidBodyHandle, RigidBodyType};
use rapier3d::glamx::{Pose3, Vec3};
use rapier3d::pipeline::PhysicsWorld;
use stochc_ir::scene::Scene;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_protocol::Orientation;

use super::ambient::{Ambient, Motion, Response};
use super::free_bonds::FreeBonds;
use super::groups::Flock;
use super::limits::Limits;
use super::magnet::pairs::Pose;
use super::magnet::{Cloud, Faces, Held, Release};
use super::plate::Seats;
use super::real::cast;
use super::rotation::quaternion;
use super::terms::Terms;
use super::{Arena, BlockFace, Body, BodyState, Docking, Fault, SceneError, World};
use crate::draw::{Draws, Stream};
use crate::settings::{Precision, Settings};

/// A world of rigid cubes.
pub struct RapierWorld {
    tick: u64,
    substeps: u32,
    terms: Terms,
    kicks: Draws,
    engine: Box<PhysicsWorld>,
    handles: Vec<RigidBodyHandle>,
    blocks: Blocks,
    seats: Seats,
    faces: Option<Faces<f32>>,
    /// `None` where nothing is around the blocks.
    ambient: Option<Ambient>,
    /// `None` where free blocks do not bond to each other.
    free_bonds: Option<FreeBonds>,
    /// The free blocks, kept to be used again.
    free: Vec<u32>,
    joints: Joints,
    /// Steps that have been made.
    steps: u64,
    limits: Limits,
}

/// A copy of what the engine knows, by number: it is read once a substep.
struct Blocks(Vec<Block>);

#[derive(Clone, Copy, Debug)]
struct Block {
    position: Vector3<f32>,
    rotation: UnitQuaternion<f32>,
    velocity: Vector3<f32>,
    spin: Vector3<f32>,
    /// How it sits in the structure; `None`: it is free.
    anchored: Option<Orientation>,
    /// The engine does not know its place yet.
    moved: bool,
}

impl RapierWorld {
    /// Where an anchored block is, and how it sits.
    fn place(&self, body: Body) -> Option<(Vector3<f32>, Orientation)> {
        match body {
            Body::Seed(cell) => Some((cast(self.seats.centre(cell)), Orientation::IDENTITY)),
            Body::Free(id) => {
                let block = &self.blocks.0[id as usize];
                Some((block.position, block.anchored?))
            }
        }
    }

    /// Fixes a block on the lattice.
    fn hold(&mut self, held: Held<f32>) {
        let rotation = quaternion(held.orientation).cast();
        let block = &mut self.blocks.0[held.body as usize];
        *block = Block {
            position: held.seat,
            rotation,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            anchored: Some(held.orientation),
            moved: false,
        };
        let body = &mut self.engine.bodies[self.handles[held.body as usize]];
        body.set_body_type(RigidBodyType::Fixed, false);
        body.set_position(Pose3::from_parts(vec3(held.seat), quat(rotation)), false);
    }

    /// Sets a block free.
    fn release(&mut self, id: u32, velocity: Vector3<f32>) {
        let block = &mut self.blocks.0[id as usize];
        (block.anchored, block.velocity) = (None, velocity);
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_body_type(RigidBodyType::Dynamic, false);
        body.set_linvel(vec3(velocity), false);
        body.set_angvel(Vec3::ZERO, false);
    }

    /// What free blocks do to each other from afar, and what becomes of groups.
    fn settle(&mut self, dt: f64, response: Response) {
        let Some(bonds) = &mut self.free_bonds else {
            return;
        };
        self.blocks.list_free(&mut self.free);
        bonds.pull(&self.free, &mut self.blocks, dt, response);
        bonds.settle(&mut self.blocks, dt, response);
        self.joints
            .follow(&mut self.engine, &self.handles, bonds.groups.bonds());
    }
}

impl Flock for Blocks {
    fn pose(&mut self, id: u32) -> Pose {
        let block = &self.0[id as usize];
        Pose {
            position: cast(block.position),
            rotation: convert::double(block.rotation),
        }
    }

    fn motion(&self, id: u32) -> Motion {
        let block = &self.0[id as usize];
        Motion {
            position: cast(block.position),
            velocity: cast(block.velocity),
            spin: cast(block.spin),
        }
    }

    fn set_pose(&mut self, id: u32, pose: &Pose) {
        let block = &mut self.0[id as usize];
        (block.position, block.rotation) = (cast(pose.position), pose.rotation.cast());
        block.moved = true;
    }

    fn set_velocity(&mut self, id: u32, velocity: Vector3<f64>, spin: Vector3<f64>) {
        let block = &mut self.0[id as usize];
        (block.velocity, block.spin) = (cast(velocity), cast(spin));
    }
}

impl Blocks {
    /// Tells the engine of the blocks that have been moved by something else.
    fn show_moved(&mut self, engine: &mut PhysicsWorld, handles: &[RigidBodyHandle]) {
        for (block, &handle) in self.0.iter_mut().zip(handles) {
            if std::mem::take(&mut block.moved) {
                let pose = Pose3::from_parts(vec3(block.position), quat(block.rotation));
                engine.bodies[handle].set_position(pose, false);
            }
        }
    }

    fn list_free(&self, free: &mut Vec<u32>) {
        free.clear();
        let is_free = |id: &u32| self.0[*id as usize].anchored.is_none();
        free.extend((0..self.0.len() as u32).filter(is_free));
    }
}

impl Arena for RapierWorld {
    fn with_blocks(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Result<RapierWorld, SceneError> {
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
        let terms = Terms::new(scene, plate)?;
        terms.check(settings)?;
        let (engine, handles) = engine::engine(&terms, plate, settings, blocks)?;
        let limits = Limits::new(settings.substeps.max(1), terms.contact.is_some());
        let limits = match (&terms.contact, terms.shell) {
            (Some(_), Some(shell)) => {
                limits.within(engine::ground_reach(shell.radius + shell.height))
            }
            _ => limits,
        };
        Ok(RapierWorld {
            tick: 0,
            substeps: settings.substeps.max(1),
            faces: terms.bond.map(Faces::new),
            ambient: Ambient::new(&terms, settings.substeps.max(1), seed, run),
            free_bonds: terms.bond.as_ref().and_then(FreeBonds::new),
            free: Vec::new(),
            joints: Joints::default(),
            steps: 0,
            terms,
            kicks: Draws::new(seed, run, Stream::Kick),
            engine,
            handles,
            blocks: Blocks(blocks.iter().map(Block::free).collect()),
            seats: Seats::new(plate),
            limits,
        })
    }

    fn count(&self) -> u32 {
        self.blocks.0.len() as u32
    }

    fn state(&self, id: u32) -> BodyState {
        let block = &self.blocks.0[id as usize];
        BodyState {
            position: cast(block.position),
            orientation: convert::double(block.rotation),
            velocity: cast(block.velocity),
            spin: cast(block.spin),
        }
    }

    fn set_state(&mut self, id: u32, state: &BodyState) {
        let block = &mut self.blocks.0[id as usize];
        if block.anchored.is_some() {
            return;
        }
        *block = Block::free(state);
        if let Some(faces) = &mut self.faces {
            faces.disturb();
        }
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_position(engine::pose(state), false);
        body.set_linvel(vec3(cast(state.velocity)), false);
        body.set_angvel(vec3(cast(state.spin)), false);
    }

    fn anchored(&self, id: u32) -> Option<Orientation> {
        self.blocks.0[id as usize].anchored
    }

    fn active(&self) -> Vec<(BlockFace, u32)> {
        self.faces.iter().flat_map(Faces::active).collect()
    }

    fn in_reach(&self) -> Vec<(BlockFace, u32, u64)> {
        self.faces.iter().flat_map(Faces::in_reach).collect()
    }

    fn groups(&self) -> Vec<Vec<u32>> {
        let groups = self.free_bonds.as_ref().map(|bonds| bonds.groups.list());
        groups.unwrap_or_default()
    }

    fn centre(&self, cell: Cell) -> Vector3<f64> {
        self.seats.centre(cell)
    }
}

impl Block {
    fn free(state: &BodyState) -> Block {
        Block {
            position: cast(state.position),
            rotation: state.orientation.cast(),
            velocity: cast(state.velocity),
            spin: cast(state.spin),
            anchored: None,
            moved: false,
        }
    }
}

impl Cloud<f32> for Blocks {
    fn position(&self, id: u32) -> Option<Vector3<f32>> {
        let block = &self.0[id as usize];
        block.anchored.is_none().then_some(block.position)
    }

    fn rotation(&mut self, id: u32) -> UnitQuaternion<f32> {
        self.0[id as usize].rotation
    }
}

impl World for RapierWorld {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, site: BlockFace) {
        let (Some((centre, orientation)), count) = (self.place(site.body), self.count()) else {
            return;
        };
        if let Some(faces) = &mut self.faces
            && faces.magnetize(site, centre, orientation)
        {
            faces.set_nearby_all(count);
        }
    }

    fn switch_off(&mut self, site: BlockFace) {
        let Some(faces) = &mut self.faces else {
            return;
        };
        let count = self.blocks.0.len() as u32;
        if let Some(Release { body: id, velocity }) = faces.switch_off(site) {
            faces.set_nearby_all(count);
            self.release(id, velocity);
            for face in Face::ALL {
                let body = Body::Free(id);
                self.switch_off(BlockFace { body, face });
            }
        }
    }

    fn plant(&mut self, site: BlockFace) -> Option<Docking> {
        self.magnetize(site);
        let free = |&id: &u32| self.blocks.0[id as usize].anchored.is_none();
        let id = (0..self.count()).rev().find(free)?;
        let count = self.count();
        let faces = self.faces.as_mut()?;
        let (held, docking) = faces.plant(site, id, self.tick)?;
        faces.set_nearby_all(count);
        self.hold(held);
        Some(docking)
    }

    fn entries(&self, site: BlockFace) -> u32 {
        self.faces.as_ref().map_or(0, |faces| faces.entries(site))
    }

    fn largest_group(&self) -> u32 {
        (self.groups().iter())
            .map(|group| group.len() as u32)
            .max()
            .unwrap_or(1)
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        for substep in 0..self.substeps {
            if let Some(faces) = &mut self.faces {
                faces.survey(self.tick, &mut self.blocks);
            }
            self.push(substep);
            self.engine.step();
            self.steps += 1;
            self.read()?;
            if let Some(faces) = &mut self.faces {
                let mut held = Vec::new();
                faces.capture(self.tick, &mut self.blocks, |block, docking| {
                    held.push(block);
                    dockings.push(docking);
                });
                let count = self.count();
                for block in held {
                    let hanging = match &mut self.free_bonds {
                        Some(bonds) => bonds.leave(block.body, &mut self.blocks),
                        None => Vec::new(),
                    };
                    self.hold(block);
                    if let Some(faces) = &mut self.faces {
                        hanging.into_iter().for_each(|body| faces.reject(body));
                        faces.set_nearby_all(count);
                    }
                }
            }
            if let Some(bonds) = &mut self.free_bonds {
                self.blocks.list_free(&mut self.free);
                let dt = 1.0 / f64::from(self.substeps);
                if bonds.join(&self.free, &mut self.blocks, dt)
                    && let Some(faces) = &mut self.faces
                {
                    faces.disturb();
                }
                (self.blocks).show_moved(&mut self.engine, &self.handles);
                self.joints
                    .follow(&mut self.engine, &self.handles, bonds.groups.bonds());
            }
        }
        self.tick += 1;
        Ok(())
    }
}
