//! Points that fill a box evenly (Latin hypercubes: M. D. McKay and others, Technometrics 21 (1979) 239).
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Points of a box within the unit cube: each is a share of the prior for every number.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// One row for each point.
    pub points: Vec<Vec<f64>>,
}

impl Design {
    /// So many points in a box, given by its lower and upper ends; the same for the same seed.
    ///
    /// In each direction, every one of as many slices of equal width as there are points has one of them.
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
