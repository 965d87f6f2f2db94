//! Full rigid cubes by a kernel of our own, made for dilute suspensions.
//!
//! The same scenes as the world of Rapier, in single or double precision, and the same rules for
//! magnets. Almost every block flies alone almost always, so that a free block costs its draws and
//! its flight, and nothing more: contacts are looked for among neighbours only, and orientations
//! are computed when somebody looks.
//!
//! Block units throughout: side 1, mass 1, tick 1. The origin is the centre of the plate's upper
//! side; z is up. A substep finds who touches whom and who is in reach, changes velocities
//! (magnets, shell, kicks, drag), moves all blocks, and then corrects the velocities and places of
//! those that touch. That is the symplectic Euler method.
mod bodies;
mod detect;
mod fault;
mod flight;
mod grid;
mod kernel;
mod lanes;
mod neighbours;
mod overlap;
mod solver;
mod turn;

use kernel::Kernel;
use nalgebra::Vector3;
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::table::Plate;
use stochc_protocol::Orientation;

use super::terms::Terms;
use super::{Arena, BlockFace, BodyState, Docking, Fault, SceneError, World};
use crate::settings::{Precision, Settings};

/// A world of rigid cubes.
pub struct RigidWorld(Inner);

enum Inner {
    Single(Box<Kernel<f32>>),
    Double(Box<Kernel<f64>>),
}

/// The same for either precision.
macro_rules! either {
    ($world:expr, $kernel:ident => $what:expr) => {
        match $world {
            Inner::Single($kernel) => $what,
            Inner::Double($kernel) => $what,
        }
    };
}

impl Arena for RigidWorld {
    fn with_blocks(
        scene: &Scene,
        plate: &Plate,
        settings: &Settings,
        seed: u64,
        run: u64,
        blocks: &[BodyState],
    ) -> Result<RigidWorld, SceneError> {
        let terms = Terms::new(scene, plate)?;
        terms.check(settings)?;
        Ok(RigidWorld(match settings.precision {
            Precision::Single => Inner::Single(Box::new(Kernel::new(
                terms, plate, settings, seed, run, blocks,
            ))),
            Precision::Double => Inner::Double(Box::new(Kernel::new(
                terms, plate, settings, seed, run, blocks,
            ))),
        }))
    }

    fn count(&self) -> u32 {
        either!(&self.0, kernel => kernel.count() as u32)
    }

    fn state(&self, id: u32) -> BodyState {
        either!(&self.0, kernel => kernel.state(id))
    }

    fn set_state(&mut self, id: u32, state: &BodyState) {
        either!(&mut self.0, kernel => kernel.set_state(id, state));
    }

    fn anchored(&self, id: u32) -> Option<Orientation> {
        either!(&self.0, kernel => kernel.anchored(id))
    }

    fn active(&self) -> Vec<(BlockFace, u32)> {
        either!(&self.0, kernel => kernel.active())
    }

    fn groups(&self) -> Vec<Vec<u32>> {
        either!(&self.0, kernel => kernel.groups())
    }

    fn in_reach(&self) -> Vec<(BlockFace, u32, u64)> {
        either!(&self.0, kernel => kernel.in_reach())
    }

    fn centre(&self, cell: Cell) -> Vector3<f64> {
        either!(&self.0, kernel => kernel.centre(cell))
    }
}

impl World for RigidWorld {
    fn tick(&self) -> u64 {
        either!(&self.0, kernel => kernel.tick())
    }

    fn magnetize(&mut self, site: BlockFace) {
        either!(&mut self.0, kernel => kernel.magnetize(site));
    }

    fn switch_off(&mut self, site: BlockFace) {
        either!(&mut self.0, kernel => kernel.switch_off(site));
    }

    fn plant(&mut self, site: BlockFace) -> Option<Docking> {
        either!(&mut self.0, kernel => kernel.plant(site))
    }

    fn entries(&self, site: BlockFace) -> u32 {
        either!(&self.0, kernel => kernel.entries(site))
    }

    fn largest_group(&self) -> u32 {
        (self.groups().iter())
            .map(|group| group.len() as u32)
            .max()
            .unwrap_or(1)
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        either!(&mut self.0, kernel => kernel.step(dockings))
    }
}
