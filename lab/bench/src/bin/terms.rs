//! Measures the cost of each term of a scene. See `lab/terms/run.py`.
//!
//! Arguments: `WITHOUT TICKS`. Moves 300 blocks with all terms except one, or with a term that has
//! almost no effect (`idle-drag`). Prints a digest of the final states.
use stochc_compiler::scene::built_in;
use stochc_ir::scene::{Agitation, Arrangement, Bond, Drag, Flow, Fluid, Scene, Stir};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld as _, World as _};
use stochc_runtime::{Model, Settings};

const PLATE: Plate = Plate { width: 3, depth: 3 };

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let ticks: u64 = args[2].parse().expect("a number of ticks");
    let (scene, blocks) = (scene(&args[1]), lattice());
    let settings = Settings::new(Model::Rigid, 1);
    let mut world = RigidWorld::with_blocks(&scene, &PLATE, &settings, 1, 0, &blocks)
        .expect("a scene that this build computes");
    for face in Face::ALL {
        let body = Body::Seed(Cell::new(1, 1, 0));
        world.magnetize(BlockFace { body, face });
    }
    let mut dockings = Vec::new();
    for _ in 0..ticks {
        world.step(&mut dockings).expect("the physics is stable");
    }
    let states = (0..world.count()).map(|id| world.state(id));
    let numbers = states.flat_map(|state| {
        let vectors = [state.position, state.velocity, state.spin];
        let turned = *state.orientation.as_vector();
        vectors
            .into_iter()
            .flat_map(|v| [v.x, v.y, v.z])
            .chain([turned.x, turned.y, turned.z, turned.w])
    });
    println!("{:016x}", numbers.map(f64::to_bits).fold(0, mix));
}

/// Returns a scene with all terms except `without`.
fn scene(without: &str) -> Scene {
    let mut scene = built_in("hemisphere_soft").expect("a built-in scene");
    scene.free.arrangement = Arrangement::Uniform;
    scene.drag = Some(Drag { rate: 0.5 });
    scene.gravity = Some(0.1);
    scene.fluid = Some(Fluid {
        density: None,
        viscosity: Some(0.1),
        added_mass: None,
    });
    scene.flow = Some(Flow::Stir(Stir {
        radius: 1.0,
        rate: 0.1,
        force: None,
        follow: 0.5,
    }));
    match without {
        "nothing" => {}
        "idle-agitation" => {
            scene.agitation = Some(Agitation::Kicks {
                speed: (0.0, 1e-30),
            })
        }
        "idle-drag" => scene.drag = Some(Drag { rate: 1e-30 }),
        "idle-bond" => {
            if let Some(Bond::Attract {
                pull,
                align,
                anchor,
                ..
            }) = &mut scene.bond
            {
                (pull.force, *align, anchor.within) = (1e-30, None, 0.0);
            }
        }
        "agitation" => scene.agitation = None,
        "bond" => scene.bond = None,
        "contact" => scene.contact = None,
        "drag" => scene.drag = None,
        "enclosure" => scene.enclosure = None,
        "fluid" => (scene.fluid, scene.flow) = (None, None),
        "gravity" => scene.gravity = None,
        "idle-fluid" => {
            scene.flow = None;
            scene.fluid = Some(Fluid {
                density: None,
                viscosity: Some(1e-30),
                added_mass: None,
            });
        }
        "idle-gravity" => scene.gravity = Some(1e-30),
        _ => panic!("no such term: {without}"),
    }
    scene
}

/// Returns 300 blocks above the plate, with different motions.
fn lattice() -> Vec<BodyState> {
    let at = |i: u32| f64::from(i) * 2.5 - 8.0;
    (0..300)
        .map(|i: u32| {
            let place =
                nalgebra::Vector3::new(at(i % 7), at(i / 7 % 7), 2.0 + 2.5 * f64::from(i / 49));
            let turn = f64::from(i) * 0.7;
            BodyState {
                velocity: nalgebra::Vector3::new(turn.cos(), turn.sin(), (2.0 * turn).cos()) * 0.15,
                spin: nalgebra::Vector3::new(turn.sin(), 0.3, turn.cos()) * 0.05,
                ..BodyState::at_rest(place)
            }
        })
        .collect()
}

/// Mixes a word into an FNV hash (Fowler, Noll and Vo).
fn mix(hash: u64, bits: u64) -> u64 {
    (hash ^ bits)
        .wrapping_mul(0x0000_0100_0000_01B3)
        .rotate_left(23)
}
