//! Turbulence as a random field: a sum of standing waves with varying amplitudes.
//!
//! Each wave runs along one of 31 axes of the icosahedron. The axes of vertices, faces and edges
//! are each isotropic to second order. Waves are transverse, so the field has no sources. The four
//! amplitudes of a wave are independent Ornstein-Uhlenbeck processes.
//!
//! # Source
//!
//! R. H. Kraichnan, Phys. Fluids 13, 22 (1970).
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::local_flow::LocalFlow;
use crate::counter_rng::{Draws, Stream, gaussians};
use crate::world::parameters::Eddies;

/// Number of waves, one per axis.
const WAVES: usize = 31;

/// Step number of the random draw for the initial amplitudes.
const BEGINNING: u64 = u64::MAX;

#[derive(Debug)]
pub(super) struct TurbulenceField {
    waves: Vec<Wave>,
    /// Fraction of an amplitude that remains after a tick.
    left: f64,
    rms: f64,
    vertical: f64,
    draws: Draws,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Wave {
    /// Wave vector, before the field is stretched.
    number: Vector3<f64>,
    /// Two directions across the wave vector.
    across: [Vector3<f64>; 2],
    /// Amplitudes of the cosines, then of the sines.
    amplitudes: [f64; 4],
}

stochc_ir::state! {
    () TurbulenceField;
    values: waves;
    parts: ;
    same: left, rms, vertical, draws
}

impl TurbulenceField {
    pub fn new(eddies: &Eddies, seed: u64, run: u64) -> TurbulenceField {
        let waves = axes().map(|axis| {
            let other = if axis.x.abs() < 0.6 {
                Vector3::x()
            } else {
                Vector3::y()
            };
            let first = axis.cross(&other).normalize();
            Wave {
                number: axis * eddies.wavenumber,
                across: [first, axis.cross(&first)],
                amplitudes: [0.0; 4],
            }
        });
        let mut field = TurbulenceField {
            waves: waves.collect(),
            left: eddies.left,
            // A wave has two directions across it. Each adds a third of its variance to each
            // velocity component.
            rms: eddies.speed * (3.0 / (2.0 * WAVES as f64)).sqrt(),
            vertical: eddies.vertical,
            draws: Draws::new(seed, run, Stream::Eddy),
        };
        field.stir(BEGINNING, 0.0, 1.0);
        field
    }

    pub fn advance(&mut self, tick: u64) {
        self.stir(tick, self.left, (1.0 - self.left * self.left).sqrt());
    }

    fn stir(&mut self, step: u64, left: f64, new: f64) {
        let mut step = self.draws.step(step);
        for (i, wave) in self.waves.iter_mut().enumerate() {
            let drawn = gaussians(step.block(i as u32));
            for (amplitude, drawn) in wave.amplitudes.iter_mut().zip(drawn) {
                *amplitude = *amplitude * left + drawn * (new * self.rms);
            }
        }
    }

    /// Adds the fluid's motion at a position.
    ///
    /// The isotropic field u(x, y, z) is stretched to (u_x, u_y, v u_z)(x, y, z / v). The
    /// divergence of both fields is zero.
    pub fn add(&self, position: Vector3<f64>, wind: &mut LocalFlow) {
        let stretched = Vector3::new(position.x, position.y, position.z / self.vertical);
        let scale = |u: Vector3<f64>| Vector3::new(u.x, u.y, u.z * self.vertical);
        for wave in &self.waves {
            let (sin, cos) = libm::sincos(wave.number.dot(&stretched));
            let [a, b, c, d] = wave.amplitudes;
            let velocity =
                wave.across[0] * (a * cos + c * sin) + wave.across[1] * (b * cos + d * sin);
            let slope = wave.across[0] * (c * cos - a * sin) + wave.across[1] * (d * cos - b * sin);
            wind.velocity += scale(velocity);
            let k = wave.number;
            let number = Vector3::new(k.x, k.y, k.z / self.vertical);
            wind.spin += number.cross(&scale(slope)) * 0.5;
        }
    }
}

/// Returns the axes through the vertices, faces and edges of an icosahedron.
fn axes() -> impl Iterator<Item = Vector3<f64>> {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let small = 1.0 / golden;
    let mut all: Vec<Vector3<f64>> = Vec::with_capacity(WAVES);
    // Even permutations of coordinates, and signs up to an overall sign.
    let mut add = |x: f64, y: f64, z: f64| {
        for signs in 0..8 {
            let sign = |bit: u32| if signs >> bit & 1 == 1 { -1.0 } else { 1.0 };
            let (x, y, z) = (x * sign(0), y * sign(1), z * sign(2));
            for axis in [
                Vector3::new(x, y, z),
                Vector3::new(y, z, x),
                Vector3::new(z, x, y),
            ] {
                let axis = axis.normalize();
                if all.iter().all(|known| known.dot(&axis).abs() < 0.999) {
                    all.push(axis);
                }
            }
        }
    };
    add(0.0, 1.0, golden);
    add(1.0, 1.0, 1.0);
    add(0.0, small, golden);
    add(1.0, 0.0, 0.0);
    add(0.5, golden / 2.0, small / 2.0);
    all.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eddies(vertical: f64) -> Eddies {
        Eddies {
            speed: 0.3,
            vertical,
            wavenumber: 1.3,
            left: 0.9,
        }
    }

    fn wind(field: &TurbulenceField, position: Vector3<f64>) -> LocalFlow {
        let mut wind = LocalFlow::default();
        field.add(position, &mut wind);
        wind
    }

    #[test]
    fn the_axes_are_isotropic() {
        let axes: Vec<_> = axes().collect();
        assert_eq!(axes.len(), WAVES);
        let sum = axes
            .iter()
            .map(|k| k * k.transpose())
            .sum::<nalgebra::Matrix3<f64>>();
        let even = nalgebra::Matrix3::identity() * (WAVES as f64 / 3.0);
        assert!((sum - even).norm() < 1e-12, "{sum}");
    }

    #[test]
    fn there_are_no_sources_and_the_spin_is_half_the_curl() {
        let h = 1e-5;
        for vertical in [1.0, 0.4, 2.5] {
            let field = TurbulenceField::new(&eddies(vertical), 3, 5);
            for position in [Vector3::new(1.0, -2.0, 3.0), Vector3::new(7.0, 0.3, 0.1)] {
                let slope = |axis: Vector3<f64>| {
                    let (more, less) = (
                        wind(&field, position + axis * h),
                        wind(&field, position - axis * h),
                    );
                    (more.velocity - less.velocity) / (2.0 * h)
                };
                let (x, y, z) = (
                    slope(Vector3::x()),
                    slope(Vector3::y()),
                    slope(Vector3::z()),
                );
                assert!((x.x + y.y + z.z).abs() < 1e-8, "{vertical} {position}");
                let half = Vector3::new(y.z - z.y, z.x - x.z, x.y - y.x) / 2.0;
                assert!(
                    (half - wind(&field, position).spin).norm() < 1e-8,
                    "{vertical} {position}"
                );
            }
        }
    }

    #[test]
    fn speed_memory_and_anisotropy_match_the_settings() {
        let (mut field, position) = (
            TurbulenceField::new(&eddies(0.5), 1, 2),
            Vector3::new(2.0, 1.0, 4.0),
        );
        let ticks = 40_000;
        let (mut squares, mut products) = (Vector3::zeros(), 0.0);
        let mut before = wind(&field, position).velocity;
        for tick in 0..ticks {
            field.advance(tick);
            let now = wind(&field, position).velocity;
            squares += now.component_mul(&now);
            products += now.x * before.x;
            before = now;
        }
        let mean = squares / ticks as f64;
        // About ticks (1 - left^2) / (1 + left^2) values are independent. The standard error of the
        // mean is therefore 2.2 %. The tolerance is four standard errors.
        let variance = 0.3 * 0.3;
        assert!((mean.x / variance - 1.0).abs() < 0.09, "{mean}");
        assert!((mean.y / variance - 1.0).abs() < 0.09, "{mean}");
        assert!((mean.z / variance / 0.25 - 1.0).abs() < 0.09, "{mean}");
        let memory = products / ticks as f64 / mean.x;
        assert!((memory - 0.9).abs() < 0.01, "{memory}");
    }
}
