//! Simulated cases: small scenes with the constants of `hemisphere_2005`.
use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use stochc_compiler::Limits;
use stochc_compiler::scene::built_in;
use stochc_ir::record::Outcome;
use stochc_ir::scene::{Enclosure, Scene};
use stochc_ir::table::{PhaseId, Tables};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BodyState, SpatialWorld};
use stochc_runtime::{Model, Settings, drive};

use super::samples::Sample;

/// Simulated numbers of substeps per tick.
pub const SUBSTEPS: [u32; 5] = [1, 2, 4, 8, 16];

/// Simulated case: a scene and a program.
pub struct Case {
    pub name: &'static str,
    pub what: &'static str,
    /// Number of free blocks.
    pub count: u32,
    /// Radius of the enclosure \[block lengths\].
    pub radius: f64,
    /// Captures of the program in order, as source text.
    pub captures: &'static str,
}

pub const CASES: [Case; 3] = [
    Case {
        name: "pair",
        what: "one block in a shell of 3 sides, captured by a face of the plate",
        count: 1,
        radius: 3.0,
        captures: "M.up -> A",
    },
    Case {
        name: "dense",
        what: "40 blocks in a shell of 8 sides, a tower of 3 on a face of the plate",
        count: 40,
        radius: 8.0,
        captures: "M.up -> A.up -> B.up -> C",
    },
    Case {
        name: "dilute",
        what: "40 blocks in a shell of 12.8 sides, the density of `hemisphere_2005`, a tower of 3",
        count: 40,
        radius: 12.8,
        captures: "M.up -> A.up -> B.up -> C",
    },
];

/// Case with settings of the computation, a cell of the result tables.
pub struct Cell {
    pub case: &'static Case,
    pub model: Model,
    pub substeps: u32,
    /// Number of solver iterations. `None` means the default of the model.
    pub iterations: Option<u32>,
    /// Friction coefficient. `None` means the value of `hemisphere_2005`.
    pub friction: Option<f64>,
}

/// Returns all cells, the cheapest first. `iterations` adds cells with other numbers of solver
/// iterations.
pub fn cells(iterations: bool) -> impl Iterator<Item = Cell> {
    let cell = |case, model, substeps, iterations| Cell {
        case,
        model,
        substeps,
        iterations,
        friction: None,
    };
    let usual = SUBSTEPS.into_iter().flat_map(move |substeps| {
        CASES.iter().flat_map(move |case| {
            [Model::Rigid, Model::Rapier].map(|model| cell(case, model, substeps, None))
        })
    });
    let other = [1, 2, 12].into_iter().filter(move |_| iterations);
    let other = other.flat_map(move |rounds| {
        CASES[..2]
            .iter()
            .map(move |case| cell(case, Model::Rapier, 4, Some(rounds)))
    });
    usual.chain(other)
}

impl Cell {
    /// Returns the sample of one run.
    pub fn sample(&self, seed: u64, run: u64) -> Sample {
        let settings = Settings {
            model: self.model,
            substeps: self.substeps,
            solver_iterations: self.iterations,
            max_ticks: Some(200_000),
            ..Settings::new(Model::Rigid, 1)
        };
        match self.model {
            Model::Rapier => self.run::<RapierWorld>(&settings, seed, run),
            _ => self.run::<RigidWorld>(&settings, seed, run),
        }
    }

    fn run<W: SpatialWorld>(&self, settings: &Settings, seed: u64, run: u64) -> Sample {
        let (mut scene, tables) = (self.case.scene(), self.case.tables());
        if let (Some(friction), Some(contact)) = (self.friction, &mut scene.contact) {
            contact.friction = friction;
        }
        let mut world = if self.case.count == 1 {
            let block = anywhere(self.case.radius, seed, run);
            W::with_blocks(&scene, &tables.plate, settings, seed, run, &[block])
        } else {
            W::new(&scene, &tables.plate, settings, seed, run)
        }
        .expect("a valid scene");
        let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
        let limit = settings.max_ticks;
        let record = drive(&tables, None, &mut world, limit, seed, run, &mut watch)
            .expect("it is not cancelled");
        if let Outcome::Failed { .. } = &record.outcome {
            eprintln!("{} run {run}: {:?}", self.case.name, record.outcome);
        }
        Sample::new(self, settings.iterations(), &record)
    }
}

impl Case {
    fn scene(&self) -> Scene {
        let mut scene = built_in("hemisphere_2005").expect("a built-in scene");
        scene.free.count = self.count;
        if let Some(Enclosure::Hemisphere { radius, .. }) = &mut scene.enclosure {
            *radius = self.radius * scene.block.side;
        }
        scene
    }

    fn tables(&self) -> Tables {
        let text = format!(
            "assembly a {{ seed plate 3 x 3 {{ M at (1, 1) }} phase grow {{ {} }} }}",
            self.captures
        );
        let mut reader = |_: &str| Ok(text.clone().into_bytes());
        let checked = stochc_compiler::check("a.sa", &mut reader, Limits::default());
        let program = checked.programs.into_iter().next();
        program
            .and_then(|p| p.tables)
            .expect("the program is valid")
    }
}

/// Returns a block at a random position in the shell above the ground, with random orientation and
/// a typical speed.
fn anywhere(radius: f64, seed: u64, run: u64) -> BodyState {
    let mut dice = ChaCha8Rng::seed_from_u64(seed << 32 | run);
    let mut point = |half: f64| loop {
        let point = Vector3::from_fn(|_, _| dice.random_range(-half..half));
        if point.norm() < half {
            break point;
        }
    };
    let position = loop {
        let position = point(radius);
        // The block must not be within reach of a face.
        if position.z > 1.6 {
            break position;
        }
    };
    let (velocity, spin) = (point(0.3), point(0.3));
    // Project a random point in a four-dimensional ball onto the surface of the ball.
    let orientation = loop {
        let q = Quaternion::from_vector(nalgebra::Vector4::from_fn(|_, _| {
            dice.random_range(-1.0..1.0)
        }));
        if (0.01..1.0).contains(&q.norm()) {
            break UnitQuaternion::from_quaternion(q);
        }
    };
    BodyState {
        position,
        orientation,
        velocity,
        spin,
    }
}
