//! Distribution of docking times: distribution function, its integral, and the inverse of the
//! integral.

/// Shape of the Erlang distribution of docking times.
pub const STAGES: i32 = 2;

/// Argument below which power series are used, because differences would lose digits. Results have
/// at least 10 correct digits.
const SMALL: f64 = 0.05;

/// Returns a + b x + c x^2 and so on.
fn sum_of_powers<const N: usize>(x: f64, factors: [f64; N]) -> f64 {
    factors
        .iter()
        .rev()
        .fold(0.0, |sum, factor| sum * x + factor)
}

/// Returns the probability that docking takes at most `time`, in units of the mean docking time.
pub(crate) fn docked(time: f64) -> f64 {
    let x = f64::from(STAGES) * time;
    docked_with(x, || libm::exp(-x))
}

/// Returns the integral of [`docked`] from 0 to a time, in units of the mean docking time.
pub(crate) fn summed(time: f64) -> f64 {
    let x = f64::from(STAGES) * time;
    summed_with(x, || libm::exp(-x))
}

/// Returns the distribution function at `x`, the time in units of the mean duration of a stage.
/// `decay` computes e^-x.
fn docked_with(x: f64, decay: impl FnOnce() -> f64) -> f64 {
    if x < SMALL {
        x * x
            * sum_of_powers(
                x,
                [1. / 2., -1. / 3., 1. / 8., -1. / 30., 1. / 144., -1. / 840.],
            )
    } else {
        1.0 - decay() * (1.0 + x)
    }
}

fn summed_with(x: f64, decay: impl FnOnce() -> f64) -> f64 {
    let integral = if x < SMALL {
        let factors = [
            1. / 6.,
            -1. / 12.,
            1. / 40.,
            -1. / 180.,
            1. / 1008.,
            -1. / 6720.,
        ];
        x * x * x * sum_of_powers(x, factors)
    } else {
        x - 2.0 + decay() * (x + 2.0)
    };
    integral / f64::from(STAGES)
}

/// Returns the inverse of [`summed`]. Newton's method starts on the side that avoids overshooting.
pub(crate) fn when_summed(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    if value == f64::INFINITY {
        return value;
    }
    // summed(t) >= t - 1; for small t with two stages, 2 t^3 / 3 (1 - t).
    let mut time = value + 1.0;
    if value < 1.0 {
        let small = libm::cbrt(1.5 * value);
        time = time.min(small + small * small);
    }
    for _ in 0..60 {
        let x = f64::from(STAGES) * time;
        let decay = libm::exp(-x);
        let next = time - (summed_with(x, || decay) - value) / docked_with(x, || decay);
        if next >= time || time - next <= 1e-13 * time {
            return next.max(0.0);
        }
        time = next;
    }
    time
}
