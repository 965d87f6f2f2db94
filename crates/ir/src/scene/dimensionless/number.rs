//! A dimensionless number of a scene, and its limits.
use serde::Serialize;

use crate::scene::Substeps;
use crate::scene::warning_kind::SceneWarningKind;

/// Dimensionless number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DimensionlessNumber {
    /// Definition of the number in the symbols of the terms.
    pub symbol: &'static str,
    /// Meaning of the number.
    pub meaning: &'static str,
    /// Value with one step per tick.
    pub value: f64,
    /// Largest value that the time step resolves. `None` if the time step does not limit the value.
    pub limit: Option<ResolutionLimit>,
    /// Expected range of the number, at any time step. `None` without such a range.
    pub expected: Option<ExpectedRange>,
    /// Rule of thumb for a working scene, without a warning.
    pub advised: Option<AdvisedRange>,
    /// Whether the number describes blocks near an open face, which may take shorter steps.
    pub of_faces: bool,
}

/// Rule of thumb for the values of working scenes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AdvisedRange {
    /// Smallest value, about.
    Least(f64),
    /// Largest value, about.
    Most(f64),
}

/// Largest value that the time step resolves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ResolutionLimit {
    /// Approximate limit of [`DimensionlessNumber::value`] with the steps that are taken.
    pub most: f64,
    /// Smallest number of substeps per tick that keeps the value within the limit. `None` if no
    /// number of substeps suffices.
    pub substeps: Option<u32>,
    /// Consequence of exceeding the limit, as part of a sentence.
    pub beyond: &'static str,
}

/// Largest value for a working scene, at any time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExpectedRange {
    /// Approximate limit.
    pub most: f64,
    /// Consequence of exceeding the limit, as part of a sentence.
    pub beyond: &'static str,
    /// Remedy for a value beyond the limit.
    pub remedy: &'static str,
    /// Kind of the warning.
    #[serde(skip)]
    pub kind: SceneWarningKind,
}

impl DimensionlessNumber {
    /// Returns whether the value exceeds its limit with `substeps` steps per tick.
    pub fn is_exceeded(&self, substeps: u32) -> bool {
        let needed = |limit: ResolutionLimit| limit.substeps;
        (self.limit).is_some_and(|limit| needed(limit).is_none_or(|needed| substeps < needed))
    }

    /// Returns the number of steps per tick of the blocks that the dimensionless number describes.
    pub fn steps_of(&self, steps: Substeps) -> u32 {
        if self.of_faces {
            steps.near
        } else {
            steps.longest()
        }
    }

    /// Returns the smallest number of substeps per tick that keeps the dimensionless number within
    /// its limit. Returns `None` if there is no limit or no such number of substeps.
    pub fn substeps(&self) -> Option<u32> {
        self.limit?.substeps
    }

    /// Returns whether the value is outside of its rule of thumb.
    pub fn is_unusual(&self) -> bool {
        match self.advised {
            Some(AdvisedRange::Least(least)) => self.value < least,
            Some(AdvisedRange::Most(most)) => self.value > most,
            None => false,
        }
    }

    /// Returns the limit for a working scene if the value exceeds it.
    pub fn disappoints(&self) -> Option<ExpectedRange> {
        self.expected.filter(|expected| self.value > expected.most)
    }
}

/// Returns the smallest number from 1 that fulfils a monotone condition, or `None` if there is
/// none.
fn fewest(is_enough: impl Fn(u32) -> bool) -> Option<u32> {
    const MAX: u32 = u32::MAX / 2;
    let mut enough = 1;
    while !is_enough(enough) {
        enough = enough.checked_mul(2).filter(|&n| n <= MAX)?;
    }
    let mut few = enough / 2;
    while enough - few > 1 {
        let middle = few + (enough - few) / 2;
        if is_enough(middle) {
            enough = middle
        } else {
            few = middle
        }
    }
    Some(enough)
}

impl DimensionlessNumber {
    pub(in crate::scene) const fn new(
        symbol: &'static str,
        meaning: &'static str,
        value: f64,
    ) -> DimensionlessNumber {
        DimensionlessNumber {
            symbol,
            meaning,
            value,
            limit: None,
            expected: None,
            advised: None,
            of_faces: false,
        }
    }

    pub(in crate::scene) const fn advised(mut self, range: AdvisedRange) -> DimensionlessNumber {
        self.advised = Some(range);
        self
    }

    pub(super) const fn of_faces(mut self) -> DimensionlessNumber {
        self.of_faces = true;
        self
    }

    /// Adds a limit for the steps that are taken. For any number of steps per tick, `at` returns
    /// the value and `most` returns the limit.
    pub(super) fn limited(
        mut self,
        taken: Substeps,
        most: impl Fn(f64) -> f64,
        at: impl Fn(f64) -> f64,
        beyond: &'static str,
    ) -> DimensionlessNumber {
        let steps = f64::from(self.steps_of(taken));
        let shrinks = at(steps) / self.value;
        let is_known = steps > 1.0 && shrinks > 0.0;
        self.limit = Some(ResolutionLimit {
            most: most(steps) / if is_known { shrinks } else { 1.0 },
            substeps: fewest(|steps| at(steps.into()) <= most(steps.into())),
            beyond,
        });
        self
    }

    pub(super) const fn expected(mut self, expected: ExpectedRange) -> DimensionlessNumber {
        self.expected = Some(expected);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE_STEP: Substeps = Substeps {
        near: 1,
        away: None,
    };

    #[test]
    fn returns_the_fewest_steps_that_resolve_a_number() {
        for (value, most, power, substeps) in [
            (0.05, 0.1, 1, Some(1)),
            (0.1, 0.1, 1, Some(1)),
            (0.2636, 0.1, 1, Some(3)),
            (6.0, 1.0, 2, Some(3)),
            (4.0, 1.0, 2, Some(2)),
            (4.0001, 1.0, 2, Some(3)),
            (1e12, 1.0, 1, None),
            (f64::INFINITY, 1.0, 2, None),
        ] {
            let at = |steps: f64| value / steps.powi(power);
            let group = DimensionlessNumber::new("", "", value).limited(ONE_STEP, |_| most, at, "");
            assert_eq!(group.substeps(), substeps, "{value}");
            assert_eq!(group.is_exceeded(1), substeps != Some(1), "{value}");
            if let Some(substeps) = substeps {
                assert!(!group.is_exceeded(substeps) && !group.is_exceeded(substeps + 1));
                assert!(substeps == 1 || group.is_exceeded(substeps - 1), "{value}");
            }
        }
        assert_eq!(DimensionlessNumber::new("", "", 1e9).substeps(), None);
    }
}
