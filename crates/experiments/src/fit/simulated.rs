//! Simulated times of a program at a point of the design.

/// Simulated times of a program at a point of the design.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// Coordinates of the point. Each is a cumulative probability of the prior of one parameter.
    pub at: Vec<f64>,
    /// Completion times of the runs, in the unit of the data.
    pub times: Vec<f64>,
    /// Number of runs that did not complete.
    pub incomplete: usize,
}

impl Simulated {
    /// Returns whether the point is in a box, given by its lower and upper ends.
    pub fn is_within(&self, ends: &[(f64, f64)]) -> bool {
        is_within(&self.at, ends)
    }
}

/// Returns whether a point is in a box, given by its lower and upper ends.
pub(super) fn is_within(at: &[f64], ends: &[(f64, f64)]) -> bool {
    let mut sides = at.iter().zip(ends);
    sides.all(|(at, (low, high))| (*low..=*high).contains(at))
}
