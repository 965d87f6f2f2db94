//! Measures the cost of an event in stochastic chemistry. The reactions are independent: each
//! consumes molecules of its own kind.
//!
//! `reactions dense|sparse REACTIONS EVENTS ROUNDS` prints the CPU time per event \[ns\] of each
//! round on a separate line.
use std::error::Error;

use rebop::gillespie::{Gillespie, Rate};
use rustix::time::{ClockId, clock_gettime};

/// Number of molecules of each kind. No kind runs out.
const MOLECULES: isize = 1_000_000_000;
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [kind, reactions, events, rounds] = &words[..] else {
        return Err("usage: reactions dense|sparse REACTIONS EVENTS ROUNDS".into());
    };
    let (count, events): (usize, usize) = (reactions.parse()?, events.parse()?);
    let is_sparse = kind == "sparse";
    let mut chemistry = Gillespie::new_with_seed(vec![MOLECULES; count], is_sparse, SEED);
    for number in 0..count {
        let rate = Rate::lma_sparse(1e-9, [(u32::try_from(number)?, 1)]);
        let mut difference = vec![0; count];
        difference[number] = -1;
        let rate = if is_sparse {
            rate
        } else {
            dense(number, count)
        };
        chemistry.add_reaction(rate, difference);
    }
    chemistry.advance_n_reactions(events);
    for _ in 0..rounds.parse()? {
        let begin = now();
        chemistry.advance_n_reactions(events);
        println!("{:.1}", (now() - begin) as f64 / events as f64);
    }
    Ok(())
}

fn dense(number: usize, count: usize) -> Rate {
    let mut needed = vec![0; count];
    needed[number] = 1;
    Rate::lma(1e-9, needed)
}

/// Returns the CPU time of this thread \[ns\].
fn now() -> i64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}
