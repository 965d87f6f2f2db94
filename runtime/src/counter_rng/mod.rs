//! Random numbers without state (counter-based): a draw is a pure function of (seed, run, stream, block, step).
//!
//! ChaCha8 is keyed by (seed, run, stream), its nonce is the step, and the words of a block sit at
//! `block * WORDS`, so that one keystream serves all blocks of a tick in order. Any draw can be
//! made again alone, whatever else was drawn before it and on whichever thread.
mod ahead;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stochc_protocol::explore::DrawIndex;

pub use ahead::DrawsAhead;

/// Words of keystream that one block owns in one step.
pub const WORDS: u32 = 4;

/// Every independent source of chance. A number is never used again for something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stream {
    /// Agitation: change of speed and direction of one block in one tick.
    Kick = 0,
    /// The world without physics: which face captures which block, and how it is turned.
    Shuffle = 1,
    /// Messages: whether a transfer, and whether its acknowledgement, is lost; its step is the
    /// number of the transfer in the run.
    Loss = 2,
    /// Exploration by chance: which of the possible steps is made.
    Schedule = 3,
    /// Turbulence: the amplitudes of one wave in one tick.
    Eddy = 4,
    /// Brownian motion: two blocks of words for one block of the scene in one step of the model.
    Heat = 5,
    /// The world of rates: its n-th draw is step n.
    Rate = 6,
    /// Statistics: how often a run counts in each sample of a bootstrap.
    Resample = 7,
}

/// The draws of one stream of one run.
#[derive(Clone, Debug)]
pub struct Draws {
    keystream: ChaCha8Rng,
}

impl Draws {
    /// The draws of `stream` in run number `run` of the ensemble with this seed.
    pub fn new(seed: u64, run: u64, stream: Stream) -> Draws {
        Draws {
            keystream: ChaCha8Rng::from_seed(key(seed, run, stream)),
        }
    }

    /// The draws of one step, from block 0 on.
    pub fn step(&mut self, step: u64) -> StepDraws<'_> {
        self.keystream.set_stream(step);
        self.keystream.set_word_pos(0);
        StepDraws {
            keystream: &mut self.keystream,
            next: 0,
        }
    }
}

/// What a stream of a run is keyed by.
fn key(seed: u64, run: u64, stream: Stream) -> [u8; 32] {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&run.to_le_bytes());
    key[16] = stream as u8;
    key
}

/// The draws of one step, cheapest in rising order of blocks.
#[derive(Debug)]
pub struct StepDraws<'a> {
    keystream: &'a mut ChaCha8Rng,
    next: u32,
}

impl StepDraws<'_> {
    /// The words of one block.
    pub fn block(&mut self, block: u32) -> [u32; WORDS as usize] {
        if block != self.next {
            self.keystream
                .set_word_pos(u128::from(block) * u128::from(WORDS));
        }
        self.next = block.wrapping_add(1);
        std::array::from_fn(|_| self.keystream.next_u32())
    }

    /// The words of blocks 0 to `blocks`, one after the other, in bytes of rising significance.
    pub fn fill(self, blocks: usize, words: &mut Vec<u8>) {
        words.resize(blocks * WORDS as usize * size_of::<u32>(), 0);
        self.keystream.set_word_pos(0);
        self.keystream.fill_bytes(words);
    }
}

/// The draws of [`Exploration::sample`](stochc_protocol::explore::Exploration::sample) with this seed.
pub fn schedules(seed: u64) -> impl FnMut(DrawIndex, u32) -> u32 {
    move |draw, n| {
        let mut draws = Draws::new(seed, draw.schedule, Stream::Schedule);
        let words = draws.step(draw.step).block(draw.attempt / WORDS);
        below(words[(draw.attempt % WORDS) as usize], n)
    }
}

/// A number in the open interval (0, 1), evenly spread: `word` is the midpoint of one of 2^32 bins.
pub fn unit(word: u32) -> f64 {
    (f64::from(word) + 0.5) / 4_294_967_296.0
}

/// Four independent numbers of mean 0 and variance 1, normally distributed (G. E. P. Box and M. E. Muller 1958).
pub(crate) fn gaussians(words: [u32; WORDS as usize]) -> [f64; 4] {
    let pair = |radius: u32, angle: u32| {
        let radius = (-2.0 * libm::log(unit(radius))).sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit(angle));
        (radius * cos, radius * sin)
    };
    let ((a, b), (c, d)) = (pair(words[0], words[1]), pair(words[2], words[3]));
    [a, b, c, d]
}

/// One of `0..n`, each within 2^-32 of equally likely.
pub fn below(word: u32, n: u32) -> u32 {
    ((u64::from(word) * u64::from(n)) >> 32) as u32
}

/// A direction, evenly spread over the sphere.
///
/// Through `libm`, because the platform's own sine may differ in the last bit.
pub fn direction(height: u32, azimuth: u32) -> [f32; 3] {
    let z = 2.0 * unit(height) - 1.0;
    let radius = (1.0 - z * z).sqrt() as f32;
    let (sin, cos) = libm::sincosf((std::f64::consts::TAU * unit(azimuth)) as f32);
    [radius * cos, radius * sin, z as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draw_does_not_depend_on_what_was_drawn_before() {
        let mut all = Draws::new(7, 3, Stream::Kick);
        let mut step = all.step(41);
        let in_order: Vec<_> = (0..50).map(|block| step.block(block)).collect();
        for block in [49, 0, 17] {
            let alone = Draws::new(7, 3, Stream::Kick).step(41).block(block);
            assert_eq!(alone, in_order[block as usize]);
        }
        let mut backwards = Draws::new(7, 3, Stream::Kick);
        backwards.step(99).block(5);
        let mut step = backwards.step(41);
        for block in (0..50).rev() {
            assert_eq!(step.block(block), in_order[block as usize]);
        }
    }

    #[test]
    fn every_part_of_the_key_matters() {
        let draw =
            |seed, run, stream, step, block| Draws::new(seed, run, stream).step(step).block(block);
        let draws = [
            draw(1, 0, Stream::Kick, 0, 0),
            draw(0, 1, Stream::Kick, 0, 0),
            draw(0, 0, Stream::Shuffle, 0, 0),
            draw(0, 0, Stream::Kick, 1, 0),
            draw(0, 0, Stream::Kick, 0, 1),
            draw(0, 0, Stream::Kick, 0, 0),
        ];
        for (i, a) in draws.iter().enumerate() {
            assert!(draws[i + 1..].iter().all(|b| a != b));
        }
    }
}
