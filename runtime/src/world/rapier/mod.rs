//! Full rigid bodies by the engine Rapier: the reference model.
//!
//! All cubes with rotation, contacts and friction, in single precision. It leaves out the fluid:
//! a block feels kicks and linear drag, none of its neighbours' wakes. Contacts are as soft as the
//! engine makes them, and with one substep a tick that is soft: see [`Settings`].
//!
//! Inside and in [`BodyState`], everything is in block units: the side of a block is 1, its mass 1,
//! the tick 1. The origin is the centre of the plate's upper side; z is up.
//!
//! A substep first changes velocities (magnets, shell, kicks, drag, in this order), then lets the
//! engine solve contacts and move the blocks, then looks who docked. As positions move with the
//! velocities just changed, this is the symplectic Euler method.
mod capture;
mod convert;
mod engine;
mod error;
mod fault;
mod magnet;
mod push;
mod start;
mod state;
mod terms;

use std::collections::BTreeMap;

use nalgebra::Vector3;
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::glamx::{Quat, Vec3};
use rapier3d::pipeline::PhysicsWorld;
use stochc_compiler::scene::Scene;
use stochc_compiler::table::Plate;
use stochc_compiler::{Cell, Face};

use super::{Body, Docking, Fault, Site, World};
use crate::draw::{Draws, Stream};
use crate::orientation::Orientation;
use crate::settings::Settings;
use capture::{Active, Sighting};
use convert::{unit_quaternion, vec3, vector};
pub use error::SceneError;
pub use state::BodyState;
use terms::Terms;

/// From the centre of a block to its faces \[side\].
const INSIDE: f32 = 0.5;

/// A world of rigid cubes.
pub struct RapierWorld {
    tick: u64,
    substeps: u32,
    terms: Terms,
    kicks: Draws,
    engine: Box<PhysicsWorld>,
    handles: Vec<RigidBodyHandle>,
    /// A copy of what the engine knows, by number: it is read once a substep.
    blocks: Vec<Block>,
    /// Where the block of the plate at (0, 0, 0) is.
    corner: Vec3,
    /// The faces that are on and hold nothing, by site.
    active: Vec<Active>,
    /// The faces that hold a block.
    holds: BTreeMap<Site, u32>,
    /// Who is in reach of what; made anew by every survey.
    sightings: Vec<Sighting>,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    position: Vec3,
    rotation: Quat,
    velocity: Vec3,
    spin: Vec3,
    /// How it sits in the structure; `None`: it is free.
    anchored: Option<Orientation>,
}

impl RapierWorld {
    /// The scene at tick 0, with the chance of run `run` of the ensemble with this `seed`.
    ///
    /// # Errors
    /// When the scene cannot be set up.
    pub fn new(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
    ) -> Result<RapierWorld, SceneError> {
        let terms = Terms::new(scene)?;
        let blocks = start::uniform(&terms, scene.free.arrangement, scene.free.count)?;
        Ok(RapierWorld::build(
            terms, plate, settings, seed, run, &blocks,
        ))
    }

    /// The scene with free blocks of one's own choice instead of its own.
    ///
    /// # Errors
    /// When the scene cannot be set up.
    pub fn with_blocks(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Result<RapierWorld, SceneError> {
        let terms = Terms::new(scene)?;
        Ok(RapierWorld::build(
            terms, plate, settings, seed, run, blocks,
        ))
    }

    fn build(
        terms: Terms,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> RapierWorld {
        let (engine, handles) = engine::engine(&terms, plate, settings, blocks);
        let half = |blocks: u32| -(blocks as f32 - 1.0) / 2.0;
        RapierWorld {
            tick: 0,
            substeps: settings.substeps.max(1),
            terms,
            kicks: Draws::new(seed, run, Stream::Kick),
            engine,
            handles,
            blocks: blocks.iter().map(Block::free).collect(),
            corner: Vec3::new(half(plate.width), half(plate.depth), -0.5),
            active: Vec::new(),
            holds: BTreeMap::new(),
            sightings: Vec::new(),
        }
    }

    /// How many blocks there are, free and anchored; their numbers are from 0.
    pub fn count(&self) -> u32 {
        self.blocks.len() as u32
    }

    /// Where a block is and how it moves.
    pub fn state(&self, id: u32) -> BodyState {
        let block = &self.blocks[id as usize];
        BodyState {
            position: vector(block.position),
            orientation: unit_quaternion(block.rotation),
            velocity: vector(block.velocity),
            spin: vector(block.spin),
        }
    }

    /// Puts a free block somewhere else, or in another motion.
    pub fn set_state(&mut self, id: u32, state: &BodyState) {
        let block = &mut self.blocks[id as usize];
        if block.anchored.is_some() {
            return;
        }
        *block = Block::free(state);
        let body = &mut self.engine.bodies[self.handles[id as usize]];
        body.set_position(engine::pose(state), false);
        body.set_linvel(vec3(state.velocity), false);
        body.set_angvel(vec3(state.spin), false);
    }

    /// How a block sits in the structure; `None`: it is free.
    pub fn anchored(&self, id: u32) -> Option<Orientation> {
        self.blocks[id as usize].anchored
    }

    /// The faces that are on and hold nothing, each with the entries into its reach so far.
    pub fn active(&self) -> impl Iterator<Item = (Site, u32)> + '_ {
        self.active
            .iter()
            .map(|active| (active.site, active.entries))
    }

    /// The centre of the block that sits in a cell \[side\].
    pub fn centre(&self, cell: Cell) -> Vector3<f64> {
        vector(self.corner + convert::normal(cell.into()))
    }

    /// Where an anchored block is, and how it sits.
    fn place(&self, body: Body) -> Option<(Vec3, Orientation)> {
        match body {
            Body::Seed(cell) => Some((
                self.corner + convert::normal(cell.into()),
                Orientation::IDENTITY,
            )),
            Body::Free(id) => {
                let block = &self.blocks[id as usize];
                Some((block.position, block.anchored?))
            }
        }
    }
}

impl Block {
    fn free(state: &BodyState) -> Block {
        Block {
            position: vec3(state.position),
            rotation: convert::quat(state.orientation),
            velocity: vec3(state.velocity),
            spin: vec3(state.spin),
            anchored: None,
        }
    }
}

impl World for RapierWorld {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, site: Site) {
        let (Some(_), Some((centre, orientation))) = (self.terms.bond, self.place(site.body))
        else {
            return;
        };
        if self.holds.contains_key(&site) {
            return;
        }
        if let Err(i) = self.active.binary_search_by_key(&site, |on| on.site) {
            let active = Active::new(site, centre, orientation);
            self.active.insert(i, active);
        }
    }

    fn switch_off(&mut self, site: Site) {
        self.active.retain(|active| active.site != site);
        if let Some(id) = self.holds.remove(&site) {
            self.release(id);
            for face in Face::ALL {
                let body = Body::Free(id);
                self.switch_off(Site { body, face });
            }
        }
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        for substep in 0..self.substeps {
            self.survey(self.tick);
            self.push(substep == 0);
            self.engine.step();
            self.read()?;
            self.survey(self.tick + 1);
            self.capture(dockings);
        }
        self.tick += 1;
        Ok(())
    }
}
