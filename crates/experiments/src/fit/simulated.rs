//! Simulated times of a program at a point of the design.
use super::observed::is_followed;
use crate::statistics::{KaplanMeier, Observation};

/// Simulated times of a program, or of one of its captures, at a point of the design.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// Coordinates of the point. Each is a cumulative probability of the prior of one parameter.
    pub at: Vec<f64>,
    /// Completed times, in the unit of the data.
    pub times: Vec<f64>,
    /// Times that did not complete, in the unit of the data.
    pub incomplete: Vec<Observation>,
}

impl Simulated {
    /// Returns whether the point is in a box, given by its lower and upper ends.
    pub fn is_within(&self, ends: &[(f64, f64)]) -> bool {
        is_within(&self.at, ends)
    }

    /// Returns whether enough of the times that are longer than the horizon were observed until
    /// then. If all times are shorter, they must have been observed until the last completion.
    pub fn is_followed(&self, horizon: f64) -> bool {
        let all = self.all();
        let Some(curve) = KaplanMeier::new(&all) else {
            return false;
        };
        // Conversions between units round the times.
        let end = horizon * (1.0 - 1e-9);
        let last = self.times.iter().copied().fold(0.0, f64::max);
        let is_over = curve.incomplete(end) == 0.0;
        is_followed(&all, &curve, if is_over { last } else { end })
    }

    /// Returns all times.
    pub(super) fn all(&self) -> Vec<Observation> {
        let completed = self.times.iter().copied().map(Observation::completed);
        completed.chain(self.incomplete.iter().copied()).collect()
    }
}

/// Returns whether a point is in a box, given by its lower and upper ends.
pub(super) fn is_within(at: &[f64], ends: &[(f64, f64)]) -> bool {
    let mut sides = at.iter().zip(ends);
    sides.all(|(at, (low, high))| (*low..=*high).contains(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_longer_times_are_followed() {
        let is_followed = |times: &[f64], censored: &[f64], never: usize| {
            let censored = censored.iter().copied().map(Observation::censored);
            let never = std::iter::repeat_n(Observation::competing(1.0), never);
            let point = Simulated {
                at: vec![0.5],
                times: times.to_vec(),
                incomplete: censored.chain(never).collect(),
            };
            point.is_followed(30.0)
        };
        assert!(is_followed(&[5.0, 40.0, 45.0], &[10.0], 0));
        assert!(is_followed(&[5.0], &[10.0], 2));
        assert!(is_followed(&[5.0], &[30.0 - 1e-12], 0));
        assert!(!is_followed(&[5.0, 40.0], &[10.0, 10.0, 20.0], 0));
        assert!(!is_followed(&[5.0], &[10.0], 0));
        // One time tells little about three others.
        assert!(!is_followed(&[20.0], &[10.0; 3], 0));
        assert!(is_followed(&[20.0, 22.0, 25.0], &[10.0; 2], 0));
        assert!(!is_followed(&[], &[], 0));
    }
}
