//! Cross-validation over the structures of a calibration.
use std::collections::BTreeMap;

use stochc_estimate::{HeldOut, KindFactor, Parameters};

use super::likelihood;
use super::observation::WaitInterval;

/// Number of parts of the cross-validation.
const FOLDS: usize = 5;

/// Weight of the rate law in the factors of kinds of surroundings \[captures\].
const PRIOR: f64 = 4.0;

/// Predicted and observed number of captures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Tally {
    predicted: f64,
    observed: f64,
}

/// Tallies by structure and by kind of surroundings.
#[derive(Debug, Default)]
struct Tallies {
    structures: BTreeMap<usize, Tally>,
    kinds: BTreeMap<u16, Tally>,
}

impl Tallies {
    fn add(&mut self, interval: &WaitInterval, predicted: f64) {
        let structure = self.structures.entry(interval.structure).or_default();
        let kind = self.kinds.entry(interval.surroundings.kind()).or_default();
        for tally in [structure, kind] {
            tally.predicted += predicted;
            tally.observed += f64::from(u8::from(interval.captured));
        }
    }

    /// Returns the larger of the errors by structure and by kind.
    fn error(&self) -> HeldOut {
        let [structures, kinds] = [error(self.structures.values()), error(self.kinds.values())];
        if structures.error >= kinds.error {
            structures
        } else {
            kinds
        }
    }
}

/// Returns the weighted root mean square of relative errors. If the predictions are exact, the
/// squared differences have the mean 1 after division by the predicted number.
fn error<'a>(tallies: impl Iterator<Item = &'a Tally>) -> HeldOut {
    let (mut squares, mut groups, mut total) = (0.0, 0.0, 0.0);
    for tally in tallies.filter(|tally| tally.predicted > 0.0) {
        let difference = tally.observed - tally.predicted;
        squares += difference * difference / tally.predicted.max(1.0);
        groups += tally.predicted.min(1.0);
        total += tally.predicted;
    }
    HeldOut {
        error: ((squares - groups).max(0.0) / total).sqrt(),
        sampling: (groups / total).sqrt(),
    }
}

/// Returns the expected number of captures in an interval.
fn predicted(interval: &WaitInterval, parameters: &Parameters) -> f64 {
    let wait = parameters.wait(&interval.surroundings);
    wait.cumulative_hazard(interval.to) - wait.cumulative_hazard(interval.from)
}

/// Returns the factors of the rates by kind of surroundings, in order of the kinds.
pub(super) fn kinds(intervals: &[WaitInterval], parameters: &Parameters) -> Vec<KindFactor> {
    let mut tallies = Tallies::default();
    for interval in intervals {
        tallies.add(interval, predicted(interval, parameters));
    }
    let factors = tallies.kinds.into_iter().map(|(kind, tally)| KindFactor {
        kind,
        factor: (tally.observed + PRIOR) / (tally.predicted + PRIOR),
    });
    factors.collect()
}

/// Returns whether factors by kind of surroundings reduce the held-out error, and the smaller
/// error.
pub(super) fn best(intervals: &[WaitInterval]) -> (bool, HeldOut) {
    let (mut of_law, mut of_kinds) = (Tallies::default(), Tallies::default());
    for fold in 0..FOLDS {
        let is_held_out = |interval: &&WaitInterval| interval.structure % FOLDS == fold;
        let others = intervals.iter().filter(|it| !is_held_out(it)).copied();
        let others: Vec<WaitInterval> = others.collect();
        let parameters = Parameters(likelihood::fit(&others).0);
        let kinds = kinds(&others, &parameters);
        for interval in intervals.iter().filter(is_held_out) {
            let predicted = predicted(interval, &parameters);
            of_law.add(interval, predicted);
            let factor = KindFactor::find(&kinds, &interval.surroundings);
            of_kinds.add(interval, predicted * factor);
        }
    }
    let (of_law, of_kinds) = (of_law.error(), of_kinds.error());
    if of_kinds.error < of_law.error {
        (true, of_kinds)
    } else {
        (false, of_law)
    }
}

#[cfg(test)]
mod tests {
    use stochc_estimate::{Neighbourhood, Surroundings, around};
    use stochc_ir::{Cell, Face};

    use super::*;

    /// Returns the waits at a face of a direction in ten structures. They have the exact quantiles
    /// of an exponential distribution.
    fn waits(direction: Face, mean: f64) -> impl Iterator<Item = WaitInterval> {
        let near = Neighbourhood::EMPTY;
        let surroundings = Surroundings {
            cold: false,
            ..around(Cell::new(0, 0, 50), direction, near, |_| None)
        };
        (0..500).map(move |number| WaitInterval {
            structure: number % 10,
            surroundings,
            from: 0.0,
            to: -mean * ((number as f64 + 0.5) / 500.0).ln(),
            captured: true,
        })
    }

    #[test]
    fn equal_structures_have_no_error() {
        let intervals: Vec<_> = waits(Face::Up, 1000.0).collect();
        let (has_kinds, held_out) = best(&intervals);
        assert!(!has_kinds && held_out.error < 0.05, "{held_out:?}");
        assert!((held_out.sampling - (10.0_f64 / 500.0).sqrt()).abs() < 0.02);
    }

    #[test]
    fn factors_by_kind_correct_the_rate_law() {
        // The rate law does not depend on the direction.
        let up = waits(Face::Up, 1000.0);
        let intervals: Vec<_> = up.chain(waits(Face::Down, 3000.0)).collect();
        let parameters = Parameters(likelihood::fit(&intervals).0);
        let mut of_law = Tallies::default();
        for interval in &intervals {
            of_law.add(interval, predicted(interval, &parameters));
        }
        assert!(of_law.error().error > 0.4, "{:?}", of_law.error());
        let (has_kinds, held_out) = best(&intervals);
        assert!(has_kinds && held_out.error < 0.1, "{held_out:?}");
        let factors: Vec<f64> = kinds(&intervals, &parameters)
            .iter()
            .map(|it| it.factor)
            .collect();
        assert!(
            (factors[0] / factors[1] / 3.0 - 1.0).abs() < 0.1,
            "{factors:?}"
        );
    }
}
