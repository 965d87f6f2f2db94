//! Measures the cost of a capture in the rate model, with towers on a square lattice that grow
//! without end.
//!
//! `captures TOWERS SPACING CAPTURES ROUNDS` prints the CPU time per capture \[ns\] of each round
//! on a separate line. At a spacing of 6, towers do not affect each other. At a spacing of 1, each
//! open face has open faces next to it.
use std::error::Error;

use rustix::time::{ClockId, clock_gettime};
use stochc_compiler::{Limits, check};
use stochc_control::{BlockFace, Body, Docking, Orientation};
use stochc_estimate::Rates;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::World;
use stochc_runtime::world::rate::RateWorld;

/// Number of captures before the measurement.
const WARM_UP: usize = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Result<Vec<usize>, _> =
        std::env::args().skip(1).map(|word| word.parse()).collect();
    let [towers, spacing, captures, rounds] = numbers?[..] else {
        return Err("usage: captures TOWERS SPACING CAPTURES ROUNDS".into());
    };
    let across = towers.isqrt();
    if across * across != towers || spacing == 0 || captures == 0 {
        return Err("TOWERS is a square number, and the others are not 0".into());
    }
    let mut growing = Growth::new(across, spacing, WARM_UP + rounds * captures)?;
    growing.grow(WARM_UP)?;
    for _ in 0..rounds {
        let begin = now();
        growing.grow(captures)?;
        println!("{:.1}", (now() - begin) as f64 / captures as f64);
    }
    Ok(())
}

/// Growing towers, each with its top face switched on.
struct Growth {
    world: RateWorld<'static>,
    /// Orientation of each block of the structure.
    orientations: Vec<Orientation>,
    dockings: Vec<Docking>,
}

impl Growth {
    fn new(across: usize, spacing: usize, captures: usize) -> Result<Growth, Box<dyn Error>> {
        let text = "assembly towers { seed plate 1 x 1 { S at (0, 0) } phase one { S.up -> A } }";
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let checked = check("towers.sa", &mut reader, Limits::default());
        let program = checked.programs.into_iter().next().ok_or("no program")?;
        let executable = program.into_executable().ok_or("the program is wrong")?;
        let (mut tables, mut scene) = (executable.tables, executable.scene);
        // The rate model uses only the named seeds of these tables.
        let seed = tables.roles.swap_remove(0);
        tables.roles.clear();
        let cells = (0..across).flat_map(|x| (0..across).map(move |y| (x * spacing, y * spacing)));
        for (x, y) in cells {
            let mut role = seed.clone();
            role.seed = Some(Cell::new(i32::try_from(x)?, i32::try_from(y)?, 0));
            tables.roles.push(role);
        }
        let mut rates = Rates::built_in(&scene).ok_or("no rates")?.clone();
        // With twice as many blocks as captures, the number of free blocks hardly affects the
        // draws.
        scene.free.count = u32::try_from(2 * captures)?;
        rates.scene = scene.clone();
        rates.free = scene.free.count;
        let rates: &'static [Rates] = Box::leak(Box::new([rates]));
        let mut world = RateWorld::new(&tables, &scene, rates, 1, 0)?;
        for (_, cell) in tables.seeds() {
            world.magnetize(BlockFace {
                body: Body::Seed(cell),
                face: Face::Up,
            });
        }
        Ok(Growth {
            world,
            orientations: vec![Orientation::IDENTITY; scene.free.count as usize],
            dockings: Vec::new(),
        })
    }

    /// Continues until at least `captures` more blocks are captured.
    fn grow(&mut self, captures: usize) -> Result<(), Box<dyn Error>> {
        let mut done = 0;
        while done < captures {
            self.world.skip(u64::MAX);
            let step = self.world.step(&mut self.dockings);
            step.map_err(|fault| fault.to_string())?;
            done += self.dockings.len();
            for docking in self.dockings.drain(..) {
                let parent = match docking.block_face.body {
                    Body::Seed(_) => Orientation::IDENTITY,
                    Body::Free(id) => self.orientations[id as usize],
                };
                let (child_face, turn) = (docking.child_face, docking.turn);
                let own = Orientation::docked(parent, docking.block_face.face, child_face, turn);
                self.orientations[docking.child as usize] = own;
                self.world.magnetize(BlockFace {
                    body: Body::Free(docking.child),
                    face: own.to_own(Face::Up),
                });
            }
        }
        Ok(())
    }
}

/// Returns the CPU time of this thread \[ns\].
fn now() -> i64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}
