//! The project's own worlds through their public interface, compared with Rapier at the same
//! settings.
use std::error::Error;

use stochc_compiler::scene::built_in;
use stochc_ir::scene::{Drag, Enclosure, Scene};
use stochc_ir::table::Plate;
use stochc_peers::drive::{Gas, State, arguments, serve};
use stochc_peers::rapier::Rapier;
use stochc_peers::scene::{DRAG, radius};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{Docking, SpatialWorld};
use stochc_runtime::{Model, Precision, Settings};

const PLATE: Plate = Plate { width: 3, depth: 3 };
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let (engine, blocks, kick) = arguments()?;
    let scene = scene(blocks, kick)?;
    let precision = match engine.as_str() {
        "rigid-world-double" => Precision::Double,
        _ => Precision::Single,
    };
    let settings = Settings {
        precision,
        ..Settings::new(Model::Rigid, 1)
    };
    let mut gas: Box<dyn Gas> = match engine.as_str() {
        "as-the-project" => Box::new(Rapier::as_the_project(blocks, kick)),
        "rapier-world" => Own::new(
            RapierWorld::new(&scene, &PLATE, &settings, SEED, 0)?,
            blocks,
        ),
        "rigid-world" | "rigid-world-double" => {
            Own::new(RigidWorld::new(&scene, &PLATE, &settings, SEED, 0)?, blocks)
        }
        _ => return Err("unknown engine".into()),
    };
    serve(&mut *gas, "stochc")
}

/// Returns `hemisphere_2005` with more blocks at the same density, with drag, and without magnets.
fn scene(blocks: u32, kick: f64) -> Result<Scene, Box<dyn Error>> {
    let mut scene = built_in("hemisphere_2005").ok_or("no scene `hemisphere_2005`")?;
    let side = scene.block.side;
    scene.free.count = blocks;
    if let Some(Enclosure::Hemisphere { radius: own, .. }) = &mut scene.enclosure {
        *own = side * radius(blocks);
    }
    let speed = (0.0, kick * side / scene.tick);
    scene.agitation = Some(stochc_ir::scene::Agitation::Kicks { speed });
    scene.drag = Some(Drag {
        rate: DRAG / scene.tick,
    });
    scene.bond = None;
    Ok(scene)
}

struct Own<W> {
    world: W,
    blocks: u32,
    dockings: Vec<Docking>,
}

impl<W: SpatialWorld + 'static> Own<W> {
    fn new(world: W, blocks: u32) -> Box<dyn Gas> {
        Box::new(Own {
            world,
            blocks,
            dockings: Vec::new(),
        })
    }
}

impl<W: SpatialWorld> Gas for Own<W> {
    fn tick(&mut self) -> Result<(), Box<dyn Error>> {
        let step = self.world.step(&mut self.dockings);
        step.map_err(|fault| format!("block {}: {}", fault.body, fault.what).into())
    }

    fn states(&self) -> Vec<State> {
        let states = (0..self.blocks).map(|id| {
            let state = self.world.state(id);
            State {
                position: state.position.into(),
                velocity: state.velocity.into(),
                rotation: state.orientation.coords.into(),
            }
        });
        states.collect()
    }

    fn contacts(&self) -> Option<usize> {
        None
    }

    fn kicks(&self) -> Option<f64> {
        None
    }
}
