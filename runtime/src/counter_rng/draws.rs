//! Random draws, addressed by key and position.
use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use stochc_control::explore::DrawIndex;

/// Number of random words in a block of words. The draws of a step consist of numbered blocks.
pub const WORDS: u32 = 4;

/// Independent source of randomness. The number of a removed source is never reused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Stream {
    /// Random impulses: change of speed and direction of one block in one tick.
    Kick = 0,
    /// Model `shuffle`: the face that captures, the block, and its orientation.
    Shuffle = 1,
    /// Loss of transfers and acknowledgements. The step is the number of the transfer in the run.
    Loss = 2,
    /// Random exploration: the choice among the possible steps.
    Schedule = 3,
    /// Turbulence: amplitudes of one wave in one tick.
    Eddy = 4,
    /// Brownian motion. Each step of the model uses two blocks of words for each block of the
    /// scene.
    Heat = 5,
    /// Draws of the model `rate`. Its n-th draw is step n.
    Rate = 6,
    /// Statistics: the weight of a run in each bootstrap sample.
    Resample = 7,
    /// Hardware faults of a scene. Step 0: whether a block is dead. Other steps: whether a latch
    /// fails at this tick.
    Fault = 8,
}

/// Random numbers of one stream in one run.
#[derive(Clone, Debug)]
pub struct Draws {
    pub(super) keystream: ChaCha8Rng,
}

impl Draws {
    /// Returns the draws of `stream` in run `run` of the ensemble with this seed.
    pub fn new(seed: u64, run: u64, stream: Stream) -> Draws {
        Draws {
            keystream: ChaCha8Rng::from_seed(key(seed, run, stream)),
        }
    }

    /// Returns the draws of one step, starting with block of words 0.
    pub fn step(&mut self, step: u64) -> StepDraws<'_> {
        self.keystream.set_stream(step);
        self.keystream.set_word_pos(0);
        StepDraws {
            keystream: &mut self.keystream,
            next: 0,
        }
    }
}

pub(super) fn key(seed: u64, run: u64, stream: Stream) -> [u8; 32] {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&run.to_le_bytes());
    key[16] = stream as u8;
    key
}

/// Draws of one step. Reading the blocks of words in ascending order is fastest.
#[derive(Debug)]
pub struct StepDraws<'a> {
    pub(super) keystream: &'a mut ChaCha8Rng,
    next: u32,
}

impl StepDraws<'_> {
    /// Returns the words of the block with this number.
    pub fn block(&mut self, block: u32) -> [u32; WORDS as usize] {
        if block != self.next {
            self.keystream
                .set_word_pos(u128::from(block) * u128::from(WORDS));
        }
        self.next = block.wrapping_add(1);
        std::array::from_fn(|_| self.keystream.next_u32())
    }

    /// Replaces `words` by the random words of the first `blocks` blocks, as little-endian bytes.
    pub fn fill(self, blocks: usize, words: &mut Vec<u8>) {
        words.resize(blocks * WORDS as usize * size_of::<u32>(), 0);
        self.keystream.set_word_pos(0);
        self.keystream.fill_bytes(words);
    }
}

/// Returns the source of random numbers for
/// [`Exploration::sample`](stochc_control::explore::Exploration::sample) with this seed.
pub fn schedules(seed: u64) -> impl FnMut(DrawIndex, u32) -> u32 {
    move |draw, n| {
        let mut draws = Draws::new(seed, draw.schedule, Stream::Schedule);
        let words = draws.step(draw.step).block(draw.attempt / WORDS);
        below(words[(draw.attempt % WORDS) as usize], n)
    }
}

/// Returns a uniform number in the open interval (0, 1): the midpoint of bin `word` of 2^32.
pub fn unit(word: u32) -> f64 {
    (f64::from(word) + 0.5) / 4_294_967_296.0
}

/// Returns four independent numbers from the standard normal distribution.
///
/// # Source
///
/// G. E. P. Box and M. E. Muller (1958).
pub(crate) fn gaussians(words: [u32; WORDS as usize]) -> [f64; 4] {
    let pair = |radius: u32, angle: u32| {
        let radius = (-2.0 * libm::log(unit(radius))).sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * unit(angle));
        (radius * cos, radius * sin)
    };
    let ((a, b), (c, d)) = (pair(words[0], words[1]), pair(words[2], words[3]));
    [a, b, c, d]
}

/// Returns a number in `0..n`. All numbers have the same probability within 2^-32.
pub fn below(word: u32, n: u32) -> u32 {
    ((u64::from(word) * u64::from(n)) >> 32) as u32
}

/// Returns a direction, uniform on the sphere.
///
/// Uses `libm`, because the sine of the platform may differ in the last bit.
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
    fn a_draw_does_not_depend_on_earlier_draws() {
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
