//! Chunk of a recording: positions of all blocks over a range of ticks, as bytes.
//!
//! A coordinate is an integer number of steps from a corner. The step of a chunk is a power of two,
//! so that resting blocks stay in place across chunks. A quaternion keeps its sign between frames.
//! Numbers are stored as second differences in time, modulo 2^16. Blocks mostly move straight and
//! rotate uniformly, so most differences are small.
use stochc_files::budget::RECORDING_PART;

use super::format::{RecordingError, deflate, inflate};

/// Number of values per position: x, y, z \[block lengths\], then the quaternion's x, y, z, w.
pub(super) const NUMBERS: usize = 7;

/// Integer that stands for 1 in a quaternion. Its resolution equals the resolution of coordinates
/// in an enclosure of 60 block lengths.
const UNIT: f64 = 4095.0;
/// Smallest possible quantization step of a coordinate \[block lengths\].
const FINEST: f64 = 1.0 / (1 << 20) as f64;

/// Returns the uncompressed size of a chunk \[bytes\].
pub(super) fn unpacked(bodies: u32, ticks: u32) -> u64 {
    // Saturated sizes exceed every limit.
    u64::from(bodies)
        .saturating_mul(u64::from(ticks))
        .saturating_mul(2 * NUMBERS as u64)
}

/// Quantized positions of all blocks at several ticks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PoseChunk {
    /// Ticks in ascending order.
    pub ticks: Vec<u64>,
    /// Coordinate of the cell with index 0 on each axis \[block lengths\].
    pub corner: [f64; 3],
    /// Size of a quantization step of coordinates \[block lengths\].
    pub step: f64,
    /// Quantized values: [`NUMBERS`] per block and tick. The tick varies fastest, then the block.
    pub numbers: Vec<u16>,
}

impl PoseChunk {
    /// Quantizes positions. `poses` contains [`NUMBERS`] values per block, tick by tick.
    pub fn quantize(ticks: Vec<u64>, poses: &[f32], bodies: usize) -> PoseChunk {
        let frames = ticks.len();
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for pose in poses.chunks_exact(NUMBERS) {
            for axis in 0..3 {
                let x = f64::from(pose[axis]);
                low[axis] = low[axis].min(x);
                high[axis] = high[axis].max(x);
            }
        }
        let mut step = FINEST;
        let corner = |step: f64| {
            low.map(|low| {
                if low.is_finite() {
                    (low / step).floor() * step
                } else {
                    0.0
                }
            })
        };
        // Terminates, because coordinates are finite.
        while (0..3).any(|axis| (high[axis] - corner(step)[axis]) / step > 65535.0) {
            step *= 2.0;
        }
        let corner = corner(step);
        let mut numbers = vec![0; NUMBERS * bodies * frames];
        for body in 0..bodies {
            let mut before = [0.0f32; 4];
            for frame in 0..frames {
                let at = (frame * bodies + body) * NUMBERS;
                let pose = &poses[at..at + NUMBERS];
                let mut put = |number: usize, value: u16| {
                    numbers[(number * bodies + body) * frames + frame] = value;
                };
                for axis in 0..3 {
                    let steps = ((f64::from(pose[axis]) - corner[axis]) / step).round();
                    // Conversion to an integer saturates, and NaN is never recorded.
                    put(axis, steps as u16);
                }
                // q and -q are the same rotation. The nearer one gives smaller differences.
                let product: f32 = (0..4).map(|i| before[i] * pose[3 + i]).sum();
                let sign = if product < 0.0 { -1.0 } else { 1.0 };
                for i in 0..4 {
                    before[i] = sign * pose[3 + i];
                    let value = (f64::from(before[i]) * UNIT).round() as i16;
                    put(3 + i, value.cast_unsigned());
                }
            }
        }
        PoseChunk {
            ticks,
            corner,
            step,
            numbers,
        }
    }

    /// Returns the position of a block: x, y, z \[block lengths\], and a unit quaternion.
    pub fn pose(&self, body: usize, frame: usize, bodies: usize) -> [f64; NUMBERS] {
        let frames = self.ticks.len();
        let number = |number: usize| self.numbers[(number * bodies + body) * frames + frame];
        let coordinate = |axis: usize| self.corner[axis] + self.step * f64::from(number(axis));
        let part = |i: usize| f64::from(number(3 + i).cast_signed()) / UNIT;
        let q = [part(0), part(1), part(2), part(3)];
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
        let [x, y, z, w] = q.map(|x| x / length);
        [coordinate(0), coordinate(1), coordinate(2), x, y, z, w]
    }

    /// Returns the chunk as bytes, for a section of a recording.
    pub fn to_bytes(&self) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let first = self.ticks.first().copied().unwrap_or(0);
        bytes.extend(first.to_le_bytes());
        bytes.extend((self.ticks.len() as u32).to_le_bytes());
        bytes.extend([0; 4]);
        for number in self.corner.into_iter().chain([self.step]) {
            bytes.extend(number.to_le_bytes());
        }
        for tick in &self.ticks {
            bytes.extend(((tick - first) as u32).to_le_bytes());
        }
        let count = self.numbers.len();
        let mut planes = vec![0; 2 * count];
        let frames = self.ticks.len().max(1);
        for (series, numbers) in self.numbers.chunks_exact(frames).enumerate() {
            let (mut before, mut change) = (0u16, 0u16);
            for (frame, &number) in numbers.iter().enumerate() {
                let delta = number.wrapping_sub(before);
                // The first value is stored directly, the second as a difference.
                let second = match frame {
                    0 | 1 => delta,
                    _ => delta.wrapping_sub(change),
                };
                (before, change) = (number, delta);
                let [low, high] = zigzag(second).to_le_bytes();
                planes[series * frames + frame] = low;
                planes[count + series * frames + frame] = high;
            }
        }
        bytes.extend(deflate(&planes)?);
        Ok(bytes)
    }

    /// Reads a chunk from the output of [`PoseChunk::to_bytes`].
    pub fn from_bytes(bytes: &[u8], bodies: u32) -> Result<PoseChunk, RecordingError> {
        const PLACES: &str = "its places";
        let corrupted = || RecordingError::Corrupted(PLACES);
        let mut rest = bytes;
        let mut take = |count: usize| {
            let (head, tail) = rest.split_at_checked(count).ok_or_else(corrupted)?;
            rest = tail;
            Ok::<&[u8], RecordingError>(head)
        };
        let first = u64::from_le_bytes(take(8)?.try_into().map_err(|_| corrupted())?);
        let frames = u32::from_le_bytes(take(4)?.try_into().map_err(|_| corrupted())?);
        take(4)?;
        let mut number = || {
            let bytes = take(8)?.try_into().map_err(|_| corrupted())?;
            Ok::<f64, RecordingError>(f64::from_le_bytes(bytes))
        };
        let corner = [number()?, number()?, number()?];
        let step = number()?;
        let offsets = take(4 * frames as usize)?.chunks_exact(4);
        let ticks: Option<Vec<u64>> = offsets
            .map(|bytes| {
                let offset = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                first.checked_add(offset.into())
            })
            .collect();
        let ticks = ticks.ok_or_else(corrupted)?;
        let count = unpacked(bodies, frames) / 2;
        if frames == 0 || unpacked(bodies, frames) > RECORDING_PART || !ticks.is_sorted() {
            return Err(corrupted());
        }
        let planes = inflate(rest, 2 * count, PLACES)?;
        let (count, frames) = (count as usize, frames as usize);
        if planes.len() != 2 * count {
            return Err(corrupted());
        }
        let (low, high) = planes.split_at(count);
        let mut numbers = vec![0; count];
        for (nth, series) in numbers.chunks_exact_mut(frames).enumerate() {
            let (mut before, mut change) = (0u16, 0u16);
            for (frame, number) in series.iter_mut().enumerate() {
                let at = nth * frames + frame;
                let second = unzigzag(u16::from_le_bytes([low[at], high[at]]));
                let delta = match frame {
                    0 | 1 => second,
                    _ => second.wrapping_add(change),
                };
                before = before.wrapping_add(delta);
                change = delta;
                *number = before;
            }
        }
        Ok(PoseChunk {
            ticks,
            corner,
            step,
            numbers,
        })
    }
}

/// Maps small positive and negative differences to small numbers.
fn zigzag(delta: u16) -> u16 {
    let delta = delta.cast_signed();
    ((delta << 1) ^ (delta >> 15)).cast_unsigned()
}

fn unzigzag(number: u16) -> u16 {
    (number >> 1) ^ (number & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zigzag_is_injective() {
        for delta in 0..=u16::MAX {
            assert_eq!(unzigzag(zigzag(delta)), delta);
        }
        let small = [0u16, 1, 2, u16::MAX, u16::MAX - 1].map(zigzag);
        assert_eq!(small, [0, 2, 4, 1, 3]);
    }

    /// Returns numbers that jump between extremes, so that first and second differences wrap.
    fn jumping(bodies: usize, frames: usize) -> PoseChunk {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            match state >> 30 {
                0 => 0,
                1 => u16::MAX,
                2 => 0x8000,
                _ => (state >> 8) as u16,
            }
        };
        PoseChunk {
            ticks: (0..frames as u64).map(|frame| 1000 + 3 * frame).collect(),
            corner: [-1.5, 0.25, 1e9],
            step: 0.125,
            numbers: (0..NUMBERS * bodies * frames).map(|_| next()).collect(),
        }
    }

    #[test]
    fn numbers_survive_wrapping_differences() {
        for (bodies, frames) in [(1, 1), (3, 2), (2, 3), (5, 100), (0, 4)] {
            let chunk = jumping(bodies, frames);
            let bytes = chunk.to_bytes().unwrap();
            assert_eq!(PoseChunk::from_bytes(&bytes, bodies as u32).unwrap(), chunk);
        }
    }

    #[test]
    fn positions_are_rounded_by_at_most_half_a_step() {
        let (bodies, frames) = (3, 50);
        let mut poses = Vec::new();
        for frame in 0..frames {
            for body in 0..bodies {
                let angle = 0.4 * frame as f32 + body as f32;
                let (sin, cos) = (angle / 2.0).sin_cos();
                let x = 20.0 * (0.3 * frame as f32).sin();
                poses.extend([x, -x + body as f32, 3.0, 0.0, 0.6 * sin, 0.8 * sin, cos]);
            }
        }
        let ticks = (0..frames as u64).collect();
        let chunk = PoseChunk::quantize(ticks, &poses, bodies);
        // 42 block lengths in 65535 steps, rounded to a power of two.
        assert_eq!(chunk.step, 1.0 / 1024.0);
        for frame in 0..frames {
            for body in 0..bodies {
                let pose = &poses[(frame * bodies + body) * NUMBERS..][..NUMBERS];
                let decoded = chunk.pose(body, frame, bodies);
                for axis in 0..3 {
                    let error = (decoded[axis] - f64::from(pose[axis])).abs();
                    assert!(error <= chunk.step / 2.0, "{error}");
                }
                let product: f64 = (3..7).map(|i| decoded[i] * f64::from(pose[i])).sum();
                let length: f64 = (3..7).map(|i| f64::from(pose[i]).powi(2)).sum();
                let product = product / length.sqrt();
                // Half a step in each of four components is an angle of at most one step. 1 - cos
                // of this angle is half its square.
                assert!(product.abs() > 1.0 - 0.5 / (UNIT * UNIT), "{product}");
            }
        }
    }

    #[test]
    fn a_block_at_rest_is_the_same_in_every_chunk() {
        let rest = [0.123_456, 7.0, 0.5, 0.0, 0.0, 0.0, 1.0];
        let poses = |other: f32| [rest, [other, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]].concat();
        let chunks = [-20.3, 21.7].map(|other| PoseChunk::quantize(vec![0], &poses(other), 2));
        assert_eq!(chunks[0].pose(0, 0, 2), chunks[1].pose(0, 0, 2));
    }

    #[test]
    fn rejects_a_corrupted_chunk() {
        let bytes = jumping(4, 20).to_bytes().unwrap();
        for cut in [0, 10, 40, bytes.len() / 2, bytes.len() - 1] {
            assert!(PoseChunk::from_bytes(&bytes[..cut], 4).is_err(), "{cut}");
        }
        assert!(PoseChunk::from_bytes(&bytes, 5).is_err());
        let mut flipped = bytes.clone();
        flipped[bytes.len() - 30] ^= 4;
        assert!(PoseChunk::from_bytes(&flipped, 4).is_err());
    }
}
