//! Space-filling designs: Latin hypercubes.
//!
//! # Source
//!
//! M. D. McKay and others, Technometrics 21, 239 (1979).
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Points of a design in a box within the unit cube. Each coordinate is a cumulative probability of
/// the prior of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// Points of the design. Each is a list of coordinates.
    pub points: Vec<Vec<f64>>,
}

impl Design {
    /// Returns a Latin hypercube of `number` points in a box with these lower and upper ends. Equal
    /// seeds give equal points.
    ///
    /// Each direction is divided into `number` slices of equal width. Every slice contains one
    /// point.
    pub fn latin_hypercube(ends: &[(f64, f64)], number: usize, seed: u64) -> Design {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut points = vec![vec![0.0; ends.len()]; number];
        for (i, (from, to)) in ends.iter().enumerate() {
            let mut slices: Vec<usize> = (0..number).collect();
            slices.shuffle(&mut random);
            for (point, slice) in points.iter_mut().zip(slices) {
                let within: f64 = random.random();
                point[i] = from + (to - from) * (slice as f64 + within) / number as f64;
            }
        }
        Design { points }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slice_has_one_point() {
        let design = Design::latin_hypercube(&[(0.0, 1.0), (0.2, 0.4)], 10, 7);
        assert_eq!(
            design,
            Design::latin_hypercube(&[(0.0, 1.0), (0.2, 0.4)], 10, 7)
        );
        for (i, (from, to)) in [(0.0, 1.0), (0.2, 0.4)].into_iter().enumerate() {
            let slice = |point: &Vec<f64>| (10.0 * (point[i] - from) / (to - from)) as usize;
            let mut slices: Vec<usize> = design.points.iter().map(slice).collect();
            slices.sort_unstable();
            assert_eq!(slices, (0..10).collect::<Vec<_>>());
        }
    }
}
