//! Protocol between `run.py` and a driver. `c/scene.h` implements the same in C.
//!
//! `DRIVER ENGINE BLOCKS KICK` starts a driver. It prints `ready` and its version. It also prints
//! the digests of its initial state and of its random impulses (`nan` for impulses of its own).
//! Then it reads commands:
//!
//! - `run TICKS` advances the scene and prints four numbers: the CPU time of the thread \[ns\], the
//!   mean square speed, the contact points per block, and the number of complaints of the engine.
//!   Speeds are in block lengths per tick. The contact points are `nan` if the engine does not
//!   report them. Engines in Rust stop instead of complaining.
//! - `state` prints one line per block: position, velocity and rotation (x, y, z, w).
//!
//! Reading speeds and contacts is not part of the measured time.
use std::error::Error;
use std::io::{self, BufWriter, Write};

use rustix::time::{ClockId, clock_gettime};

use crate::scene;

/// Number of ticks between two readings of speeds and contacts.
const STRIDE: u64 = 10;

/// Scene in a physics engine.
pub trait Gas {
    /// Advances the scene by one tick. The whole call is measured.
    fn tick(&mut self) -> Result<(), Box<dyn Error>>;
    /// Returns all blocks, in block units.
    fn states(&self) -> Vec<State>;
    /// Returns the number of contact points. Returns `None` if the engine does not report it.
    fn contacts(&self) -> Option<usize>;
    /// Returns the digest of the random impulses. Returns `None` if the engine draws its own.
    fn kicks(&self) -> Option<f64>;
}

/// Position and motion of a block, in block units.
pub struct State {
    pub position: [f64; 3],
    pub velocity: [f64; 3],
    /// Rotation as a quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// Returns the arguments of a driver: engine, number of blocks, and largest random impulse.
pub fn arguments() -> Result<(String, u32, f64), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [engine, blocks, kick] = words.as_slice() else {
        return Err("usage: ENGINE BLOCKS KICK".into());
    };
    Ok((engine.clone(), blocks.parse()?, kick.parse()?))
}

/// Reads commands from standard input and executes them until the input ends.
pub fn serve(gas: &mut dyn Gas, version: &str) -> Result<(), Box<dyn Error>> {
    let start = scene::digest(gas.states().iter().map(|state| state.position));
    println!(
        "ready {start} {} {version}",
        gas.kicks().unwrap_or(f64::NAN)
    );
    for line in io::stdin().lines() {
        match line?.split_whitespace().collect::<Vec<_>>()[..] {
            ["run", ticks] => run(gas, ticks.parse()?)?,
            ["state"] => print_state(gas)?,
            _ => return Err("unknown order".into()),
        }
    }
    Ok(())
}

fn run(gas: &mut dyn Gas, ticks: u64) -> Result<(), Box<dyn Error>> {
    let (mut time, mut square, mut contacts, mut looks) = (0, 0.0, 0.0, 0.0);
    let mut left = ticks;
    while left > 0 {
        let stride = left.min(STRIDE);
        left -= stride;
        let begin = now();
        for _ in 0..stride {
            gas.tick()?;
        }
        time += now() - begin;
        let states = gas.states();
        let speeds = states.iter().map(|state| state.velocity);
        looks += states.len() as f64;
        square += speeds.flatten().map(|v| v * v).sum::<f64>();
        contacts += gas.contacts().map_or(f64::NAN, |count| count as f64);
    }
    println!("{time} {} {} 0", square / looks, contacts / looks);
    Ok(())
}

fn print_state(gas: &dyn Gas) -> Result<(), Box<dyn Error>> {
    let mut out = BufWriter::new(io::stdout().lock());
    for state in gas.states() {
        let [x, y, z] = state.position;
        let [u, v, w] = state.velocity;
        let [a, b, c, d] = state.rotation;
        writeln!(out, "{x} {y} {z} {u} {v} {w} {a} {b} {c} {d}")?;
    }
    Ok(out.flush()?)
}

/// Returns the CPU time of this thread \[ns\].
fn now() -> i64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}
