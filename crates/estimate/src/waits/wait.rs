//! Distribution of the waiting time of an open face.
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::waits::docking_time::{STAGES, docked, summed, when_summed};
use crate::waits::inverse::{about_when_summed, bounds};

/// Waiting time of an open face in constant surroundings.
///
/// Blocks that will dock arrive as a Poisson process. Each of these blocks needs a docking time
/// from an Erlang distribution with [`STAGES`] stages. The first block to finish is captured. The
/// hazard of a face that has been open for s ticks is therefore `rate G(s)`. G is the distribution
/// function of the docking time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wait {
    /// Rate of arrivals that will dock \[1/tick\].
    pub rate: f64,
    /// Mean docking time \[ticks\].
    pub docking: f64,
}

impl Wait {
    /// Returns the waiting time halfway between two surroundings: the geometric means of both
    /// parameters.
    #[must_use]
    pub fn between(self, other: Wait) -> Wait {
        Wait {
            rate: (self.rate * other.rate).sqrt(),
            docking: (self.docking * other.docking).sqrt(),
        }
    }

    /// Returns the hazard after a number of ticks \[1/tick\].
    pub fn hazard(self, ticks: f64) -> f64 {
        self.rate * docked(ticks / self.docking)
    }

    /// Returns the cumulative hazard after a time \[ticks\].
    pub fn cumulative_hazard(self, ticks: f64) -> f64 {
        self.rate * self.docking * summed(ticks / self.docking)
    }

    /// Returns the cumulative hazards of two waiting times after a time \[ticks\].
    pub fn cumulative_hazards(of: [Wait; 2], ticks: f64) -> [f64; 2] {
        let [one, other] = of;
        let summed_one = summed(ticks / one.docking);
        let summed_other = if one.docking == other.docking {
            summed_one
        } else {
            summed(ticks / other.docking)
        };
        [
            one.rate * one.docking * summed_one,
            other.rate * other.docking * summed_other,
        ]
    }

    /// Returns two derivatives with respect to the logarithm of the docking time: of the cumulative
    /// hazard, and of the logarithmic hazard.
    pub fn docking_slopes(self, ticks: f64) -> (f64, f64) {
        let time = ticks / self.docking;
        let x = f64::from(STAGES) * time;
        let dock = docked(time);
        let summed = self.rate * self.docking * (summed(time) - time * dock);
        // d G / d ln x = x^2 e^-x with two stages.
        let hazard = if x < 1e-3 {
            -2.0
        } else {
            -x * x * libm::exp(-x) / dock
        };
        (summed, hazard)
    }

    /// Returns the time when the cumulative hazard reaches a value \[ticks\]. Infinite without
    /// arrivals.
    pub fn time_of(self, cumulative_hazard: f64) -> f64 {
        self.docking * when_summed(cumulative_hazard / (self.rate * self.docking))
    }

    /// Returns [`Wait::time_of`] faster, with a relative error of 1e-7.
    pub(crate) fn about_time_of(self, cumulative_hazard: f64) -> f64 {
        self.docking * about_when_summed(cumulative_hazard / (self.rate * self.docking))
    }

    /// Returns bounds of [`Wait::time_of`], which are faster to compute.
    pub fn time_bounds(self, cumulative_hazard: f64) -> (f64, f64) {
        let (low, high) = bounds(cumulative_hazard / (self.rate * self.docking));
        (self.docking * low, self.docking * high)
    }

    /// Returns the probability of a capture by this time.
    pub fn distribution(self, ticks: f64) -> f64 {
        -libm::expm1(-self.cumulative_hazard(ticks))
    }

    /// Returns the mean waiting time and its variance \[ticks, ticks^2\], with a relative error of
    /// about 1e-4.
    pub fn moments(self) -> (f64, f64) {
        // Expectation over an exponential cumulative hazard with mean 1. Gauss-Laguerre nodes would
        // miss the root at 0. Midpoints of equal probabilities are accurate to second order.
        let (mut mean, mut square) = (0.0, 0.0);
        for &exponential in MIDDLES.iter() {
            let time = self.about_time_of(exponential);
            mean += time;
            square += time * time;
        }
        let parts = PARTS as f64;
        let mean = mean / parts;
        (mean, square / parts - mean * mean)
    }

    /// Returns the mean waiting time \[ticks\].
    pub fn mean(self) -> f64 {
        self.moments().0
    }
}

/// Number of parts of equal probability for the computation of moments.
const PARTS: usize = 256;

/// Means of an exponential variable of mean 1 within each of [`PARTS`] intervals of equal
/// probability.
static MIDDLES: LazyLock<[f64; PARTS]> = LazyLock::new(|| {
    // Integral of -ln(1 - p) from p = 0.
    let integral = |p: f64| {
        if p < 1.0 {
            p + (1.0 - p) * libm::log1p(-p)
        } else {
            1.0
        }
    };
    let parts = PARTS as f64;
    std::array::from_fn(|part| {
        let (from, to) = (part as f64 / parts, (part + 1) as f64 / parts);
        (integral(to) - integral(from)) * parts
    })
});

#[cfg(test)]
mod tests {
    use super::*;

    const WAIT: Wait = Wait {
        rate: 1.0 / 300.0,
        docking: 200.0,
    };

    #[test]
    fn the_inverse_inverts_the_cumulative_hazard() {
        let mut value = 1e-12;
        while value < 1e9 {
            let time = when_summed(value);
            let again = summed(time);
            assert!(
                (again - value).abs() <= 1e-9 * value,
                "{value}: {time} {again}"
            );
            value *= 1.01;
        }
    }

    #[test]
    fn functions_are_continuous_between_branches() {
        for (function, x) in [(docked as fn(f64) -> f64, 0.025), (summed, 0.025)] {
            let (below, above) = (function(x * (1.0 - 1e-9)), function(x * (1.0 + 1e-9)));
            assert!((above - below).abs() < 1e-8 * below, "{below} {above}");
        }
    }

    #[test]
    fn the_hazard_is_the_derivative_of_the_cumulative_hazard() {
        for ticks in [1.0, 50.0, 200.0, 2000.0] {
            let step = 1e-3;
            let slope = (WAIT.cumulative_hazard(ticks + step)
                - WAIT.cumulative_hazard(ticks - step))
                / (2.0 * step);
            assert!((slope / WAIT.hazard(ticks) - 1.0).abs() < 1e-4, "{ticks}");
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for ticks in [0.01, 20.0, 200.0, 5000.0] {
            let step: f64 = 1e-5;
            let with = |factor: f64| Wait {
                docking: WAIT.docking * libm::exp(factor),
                ..WAIT
            };
            let (more, less) = (with(step), with(-step));
            let summed =
                (more.cumulative_hazard(ticks) - less.cumulative_hazard(ticks)) / (2.0 * step);
            let hazard = libm::log(more.hazard(ticks) / less.hazard(ticks)) / (2.0 * step);
            let slopes = WAIT.docking_slopes(ticks);
            assert!(
                (slopes.0 - summed).abs() <= 1e-4 * summed.abs() + 1e-12,
                "{ticks}: {slopes:?} {summed}"
            );
            assert!(
                (slopes.1 - hazard).abs() < 1e-3,
                "{ticks}: {slopes:?} {hazard}"
            );
        }
    }

    #[test]
    fn moments_agree_with_the_distribution() {
        for wait in [
            WAIT,
            Wait {
                rate: 1e-3,
                docking: 1.0,
            },
            Wait {
                rate: 1.0,
                docking: 500.0,
            },
        ] {
            let (mean, variance) = wait.moments();
            // E T = integral of P(T > t), E T^2 = integral of 2 t P(T > t).
            let longest = wait.time_of(40.0);
            let steps = 400_000;
            let step = longest / f64::from(steps);
            let (mut first, mut second) = (0.0, 0.0);
            for i in 0..steps {
                let time = (f64::from(i) + 0.5) * step;
                let waits = libm::exp(-wait.cumulative_hazard(time)) * step;
                first += waits;
                second += 2.0 * time * waits;
            }
            assert!((mean / first - 1.0).abs() < 1e-4, "{mean} {first}");
            let exact = second - first * first;
            assert!((variance / exact - 1.0).abs() < 1e-2, "{variance} {exact}");
        }
    }

    #[test]
    fn with_rate_zero_a_face_waits_forever() {
        let wait = Wait { rate: 0.0, ..WAIT };
        assert_eq!(wait.time_of(1e-9), f64::INFINITY);
        assert_eq!(wait.mean(), f64::INFINITY);
    }

    #[test]
    fn without_docking_times_waits_are_exponential() {
        let wait = Wait {
            rate: 0.01,
            docking: 1e-6,
        };
        let (mean, variance) = wait.moments();
        assert!((mean - 100.0).abs() < 0.01, "{mean}");
        assert!((variance - 1e4).abs() < 100.0, "{variance}");
    }
}
