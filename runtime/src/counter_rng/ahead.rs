//! The first draws of successive steps, computed for four steps at once.
//!
//! A generator computes sixty-four words even if a step needs only four. For cheap steps this would
//! dominate the run time.
use wide::u32x4;

use super::draws::key;
use super::{Stream, WORDS};

/// Number of steps whose draws are computed together.
const LANES: usize = 4;

/// Number of words in one block of a ChaCha keystream.
const BLOCK: usize = 16;

/// Random numbers of one stream, computed for several steps at once, with the same values as
/// [`Draws`](super::Draws). Contains only blocks of words 0 to 3 of each step. Fastest if steps are
/// read in ascending order, or if only block 0 is read.
#[derive(Clone, Debug)]
pub struct DrawsAhead {
    key: [u32; 8],
    front: Ahead<{ WORDS as usize }>,
    all: Ahead<BLOCK>,
}

/// Cache of the first `COUNT` words of [`LANES`] successive steps.
#[derive(Clone, Debug)]
struct Ahead<const COUNT: usize> {
    /// First step whose words are available. `None` if no words are available.
    first: Option<u64>,
    words: [[u32; LANES]; COUNT],
}

impl DrawsAhead {
    /// Returns the draws of `stream` in run `run` of the ensemble with this seed.
    pub fn new(seed: u64, run: u64, stream: Stream) -> DrawsAhead {
        let key = key(seed, run, stream);
        let word = |i: usize| std::array::from_fn(|byte| key[4 * i + byte]);
        DrawsAhead {
            key: std::array::from_fn(|i| u32::from_le_bytes(word(i))),
            front: Ahead::NONE,
            all: Ahead::NONE,
        }
    }

    /// Returns the random words of block 0, 1, 2 or 3 in one step.
    #[inline]
    pub fn block(&mut self, step: u64, block: u32) -> [u32; WORDS as usize] {
        let first = (block * WORDS) as usize;
        match block {
            0 if self.all.lane(step).is_none() => self.front.words(&self.key, step, first),
            _ => self.all.words(&self.key, step, first),
        }
    }
}

impl<const COUNT: usize> Ahead<COUNT> {
    const NONE: Self = Ahead {
        first: None,
        words: [[0; LANES]; COUNT],
    };

    /// Returns the index of a step among the computed steps, or `None` if its words are not
    /// available.
    #[inline]
    fn lane(&self, step: u64) -> Option<usize> {
        let lane = self.first.and_then(|first| step.checked_sub(first))?;
        (lane < LANES as u64).then_some(lane as usize)
    }

    #[inline]
    fn words(&mut self, key: &[u32; 8], step: u64, first: usize) -> [u32; WORDS as usize] {
        let lane = self.lane(step).unwrap_or_else(|| {
            self.first = Some(step);
            self.words = keystreams(key, step);
            0
        });
        std::array::from_fn(|word| self.words[first + word][lane])
    }
}

/// Returns the first words of the ChaCha8 keystreams with successive nonces, at most one block
/// each.
///
/// # Source
///
/// D. J. Bernstein, ChaCha, a variant of Salsa20 (2008).
fn keystreams<const COUNT: usize>(key: &[u32; 8], nonce: u64) -> [[u32; LANES]; COUNT] {
    let nonces: [u64; LANES] = std::array::from_fn(|lane| nonce.wrapping_add(lane as u64));
    let start: [u32x4; BLOCK] = std::array::from_fn(|word| match word {
        0 => u32x4::splat(0x6170_7865),
        1 => u32x4::splat(0x3320_646e),
        2 => u32x4::splat(0x7962_2d32),
        3 => u32x4::splat(0x6b20_6574),
        4..12 => u32x4::splat(key[word - 4]),
        12 | 13 => u32x4::splat(0),
        14 => u32x4::new(nonces.map(|nonce| nonce as u32)),
        _ => u32x4::new(nonces.map(|nonce| (nonce >> 32) as u32)),
    });
    let mut w = start;
    for _ in 0..3 {
        double_round(&mut w);
    }
    // The last round is outside the loop so that the compiler omits the work for unused words.
    double_round(&mut w);
    std::array::from_fn(|word| (w[word] + start[word]).to_array())
}

#[inline(always)]
fn double_round(w: &mut [u32x4; BLOCK]) {
    quarter_round::<0, 4, 8, 12>(w);
    quarter_round::<1, 5, 9, 13>(w);
    quarter_round::<2, 6, 10, 14>(w);
    quarter_round::<3, 7, 11, 15>(w);
    quarter_round::<0, 5, 10, 15>(w);
    quarter_round::<1, 6, 11, 12>(w);
    quarter_round::<2, 7, 8, 13>(w);
    quarter_round::<3, 4, 9, 14>(w);
}

#[inline(always)]
fn quarter_round<const A: usize, const B: usize, const C: usize, const D: usize>(
    w: &mut [u32x4; BLOCK],
) {
    w[A] += w[B];
    w[D] = turned::<16>(w[D] ^ w[A]);
    w[C] += w[D];
    w[B] = turned::<12>(w[B] ^ w[C]);
    w[A] += w[B];
    w[D] = turned::<8>(w[D] ^ w[A]);
    w[C] += w[D];
    w[B] = turned::<7>(w[B] ^ w[C]);
}

#[inline(always)]
fn turned<const BITS: i32>(word: u32x4) -> u32x4 {
    (word << BITS) | (word >> (32 - BITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::counter_rng::Draws;

    #[test]
    fn draws_do_not_depend_on_the_order_of_steps() {
        let (mut one, mut ahead) = (
            Draws::new(u64::MAX - 7, 3, Stream::Shuffle),
            DrawsAhead::new(u64::MAX - 7, 3, Stream::Shuffle),
        );
        let far = [
            u64::from(u32::MAX) - 2,
            u64::MAX - 2,
            u64::MAX,
            17,
            16,
            18,
            0,
        ];
        for step in (0..50)
            .chain((u64::from(u32::MAX) - 5)..(u64::from(u32::MAX) + 5))
            .chain(far)
        {
            for block in [0, 1, 2, 3, 1] {
                assert_eq!(
                    ahead.block(step, block),
                    one.step(step).block(block),
                    "{step} {block}"
                );
            }
        }
    }
}
