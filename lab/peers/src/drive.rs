//! How `run.py` talks to a driver; `c/scene.h` is the same in C.
//!
//! A driver is started as `DRIVER ENGINE BLOCKS KICK` and says `ready`, the digests of its start
//! and of its kicks (`nan`: kicks of its own), and its version. Then it obeys lines:
//!
//! - `run TICKS`: moves on and says the CPU time of its thread \[ns\], the mean square speed
//!   \[side^2 / tick^2\], the contact points per block (`nan`: the engine does not tell), and how
//!   often the engine complained (those in Rust stop instead);
//! - `state`: says one line per block, position, velocity and rotation (x, y, z, w).
//!
//! The clock stands still while speeds and contacts are looked at.
use std::error::Error;
use std::io::{self, BufWriter, Write};

use rustix::time::{ClockId, clock_gettime};

use crate::scene;

/// Ticks between two looks at speeds and contacts.
const STRIDE: u64 = 10;

/// A scene in an engine.
pub trait Gas {
    /// Advances one tick; all of it is measured.
    fn tick(&mut self) -> Result<(), Box<dyn Error>>;
    /// All blocks, in block units.
    fn states(&self) -> Vec<State>;
    /// Contact points that the engine has now, if it tells.
    fn contacts(&self) -> Option<usize>;
    /// Digest of the kicks, if they are the common ones.
    fn kicks(&self) -> Option<f64>;
}

/// Where a block is and how it moves, in block units.
pub struct State {
    pub position: [f64; 3],
    pub velocity: [f64; 3],
    /// Quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// The arguments of a driver: engine, blocks and kick.
pub fn arguments() -> Result<(String, u32, f64), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [engine, blocks, kick] = words.as_slice() else {
        return Err("usage: ENGINE BLOCKS KICK".into());
    };
    Ok((engine.clone(), blocks.parse()?, kick.parse()?))
}

/// Does as it is told until its input ends.
pub fn serve(gas: &mut dyn Gas, version: &str) -> Result<(), Box<dyn Error>> {
    let start = scene::digest(gas.states().iter().map(|state| state.position));
    println!(
        "ready {start} {} {version}",
        gas.kicks().unwrap_or(f64::NAN)
    );
    for line in io::stdin().lines() {
        match line?.split_whitespace().collect::<Vec<_>>()[..] {
            ["run", ticks] => run(gas, ticks.parse()?)?,
            ["state"] => tell(gas)?,
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

fn tell(gas: &dyn Gas) -> Result<(), Box<dyn Error>> {
    let mut out = BufWriter::new(io::stdout().lock());
    for state in gas.states() {
        let [x, y, z] = state.position;
        let [u, v, w] = state.velocity;
        let [a, b, c, d] = state.rotation;
        writeln!(out, "{x} {y} {z} {u} {v} {w} {a} {b} {c} {d}")?;
    }
    Ok(out.flush()?)
}

/// CPU time of this thread \[ns\].
fn now() -> i64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}
