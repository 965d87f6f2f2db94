//! Priors of parameters: uniform between two values.
use crate::sweep::{Parameter, RangeError, common, digits, logarithmic, value};
use stochc_results::Varied;

/// Prior of a parameter of a scene or program: its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Name of the parameter, such as `bond.pull`.
    pub name: String,
    /// Lower end of the range, in `unit`.
    pub from: f64,
    /// Upper end of the range, in `unit`.
    pub to: f64,
    /// Unit as the user wrote it. Empty if the parameter has no unit.
    pub unit: String,
    /// Whether the logarithm of the value is uniformly distributed, instead of the value.
    pub is_logarithmic: bool,
    /// Whether the parameter must be an integer. Set by [`Prior::for_parameter`].
    pub is_whole: bool,
}

/// Smallest range of an integer parameter that allows fitting a polynomial.
const MIN_SPAN: f64 = 4.0;

impl Prior {
    /// Parses `NAME=FROM..TO`, such as `bond.pull=2..12 N` or `drag.rate=0.1..10 /s log`.
    ///
    /// # Errors
    ///
    /// If the format or the range is wrong. Does not check whether the parameter exists.
    pub fn parse(text: &str) -> Result<Prior, RangeError> {
        let (name, range) = text.split_once('=').ok_or(RangeError::Prior)?;
        let (range, is_logarithmic) = logarithmic(range);
        let (from, to) = range.split_once("..").ok_or(RangeError::Prior)?;
        if name.trim().is_empty() || to.contains('/') && to.rsplit('/').next().is_some_and(is_count)
        {
            return Err(RangeError::Prior);
        }
        let ends = [value(from)?, value(to)?];
        let unit = common(&ends)?;
        let [from, to] = ends.map(|(end, _)| end);
        if from >= to || !(from.is_finite() && to.is_finite()) {
            return Err(RangeError::Empty { from, to });
        }
        if is_logarithmic && from <= 0.0 {
            return Err(RangeError::PriorWithLog);
        }
        Ok(Prior {
            name: name.trim().to_owned(),
            from,
            to,
            unit,
            is_logarithmic,
            is_whole: false,
        })
    }

    /// Checks the prior of a parameter and returns it.
    ///
    /// # Errors
    ///
    /// If an end is out of range, or an integer range is too short.
    pub fn for_parameter(self, parameter: Parameter<'_>) -> Result<Prior, RangeError> {
        for end in [self.from, self.to] {
            parameter.with_value(end, &self.unit)?;
        }
        if parameter.is_whole() && self.to - self.from < MIN_SPAN {
            return Err(RangeError::ShortRange(self.name));
        }
        Ok(Prior {
            is_whole: parameter.is_whole(),
            ..self
        })
    }

    /// Returns the value at a probability of the prior, from 0 to 1, in `unit`.
    pub fn value(&self, share: f64) -> f64 {
        if self.is_logarithmic {
            self.from * (self.to / self.from).powf(share)
        } else {
            self.from + (self.to - self.from) * share
        }
    }

    /// Returns the probability that the prior gives to values below `value`.
    pub fn share(&self, value: f64) -> f64 {
        let share = if self.is_logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        };
        share.clamp(0.0, 1.0)
    }

    /// Returns the probability nearest to `share` whose value is valid, such as an integer.
    pub fn possible(&self, share: f64) -> f64 {
        if self.is_whole {
            self.share(self.value(share).round())
        } else {
            share
        }
    }

    /// Extends an interval of probabilities until the values at its ends are valid.
    pub fn outward(&self, (low, high): (f64, f64)) -> (f64, f64) {
        if self.is_whole {
            (
                self.share(self.value(low).floor()),
                self.share(self.value(high).ceil()),
            )
        } else {
            (low, high)
        }
    }

    /// Extends an interval of probabilities. If the parameter is an integer, the result contains
    /// enough values for fitting a polynomial.
    pub fn surroundings(&self, ends: (f64, f64)) -> (f64, f64) {
        let (low, high) = self.outward(ends);
        if !self.is_whole {
            return (low, high);
        }
        let [from, to] = [low, high].map(|share| self.value(share).round());
        let lacking = (MIN_SPAN - (to - from)).max(0.0);
        let from = (from - (lacking / 2.0).ceil()).max(self.from);
        let to = to.max(from + MIN_SPAN).min(self.to);
        (self.share((to - MIN_SPAN).min(from)), self.share(to))
    }

    /// Returns the value at a probability of the prior as simulations use it, in `unit`.
    pub fn rounded(&self, share: f64) -> f64 {
        self.round(self.value(share))
    }

    fn round(&self, value: f64) -> f64 {
        if self.is_whole {
            value.round()
        } else {
            digits(value, 7)
        }
    }

    /// Returns the parameter with its value at a probability of the prior.
    ///
    /// # Errors
    ///
    /// If the value is invalid.
    pub fn varied(&self, share: f64, parameter: Parameter<'_>) -> Result<Varied, RangeError> {
        self.varied_to(self.value(share), parameter)
    }

    /// Returns the parameter with a value that is given in `unit`.
    ///
    /// # Errors
    ///
    /// See [`Prior::varied`].
    pub fn varied_to(&self, value: f64, parameter: Parameter<'_>) -> Result<Varied, RangeError> {
        parameter.with_value(self.round(value), &self.unit)
    }
}

/// Returns whether a sweep would read a text, such as `6`, as a number of values.
fn is_count(text: &str) -> bool {
    !text.trim().is_empty() && text.trim().chars().all(|c| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use stochc_compiler::scene::built_in;
    use stochc_ir::scene::Scene;

    use super::*;
    use crate::sweep::number;

    /// Returns a prior of a parameter of the scene.
    fn prior(text: &str, scene: &Scene) -> Result<Prior, RangeError> {
        let prior = Prior::parse(text)?;
        let number = number(scene, &prior.name)?;
        prior.for_parameter(Parameter::Scene(number))
    }

    #[test]
    fn a_range_is_read_with_its_unit() {
        let pull = Prior::parse("bond.pull = 2..12 N").unwrap();
        assert_eq!((pull.from, pull.to, &*pull.unit), (2.0, 12.0, "N"));
        assert!((pull.value(0.25) - 4.5).abs() < 1e-12);
        let scene = built_in("hemisphere").unwrap();
        let prior = prior("free=50..5000 log", &scene).unwrap();
        assert!(prior.is_logarithmic);
        let free = Parameter::Scene(number(&scene, "free").unwrap());
        let varied = prior.varied(0.5, free).unwrap();
        assert_eq!((varied.name.as_str(), varied.given), ("free", 500.0));
    }

    #[test]
    fn integer_parameters_stay_integers() {
        let scene = built_in("hemisphere").unwrap();
        let of = |text: &str| prior(text, &scene);
        for text in ["free=8..20", "free=8..2000 log"] {
            let prior = of(text).unwrap();
            for share in [0.0, 0.03, 0.49, 0.77, 1.0] {
                let value = prior.value(prior.possible(share));
                assert!((value - prior.value(share).round()).abs() < 1e-9, "{value}");
                for (low, high) in [(share, share), (0.3 * share, 0.5 + 0.5 * share)] {
                    let (below, above) = prior.outward((low, high));
                    assert!(below <= low && high <= above, "{text} {low} {high}");
                    let (from, to) = prior.surroundings((low, high));
                    assert!(from <= below && above <= to, "{text} {low} {high}");
                    let span = prior.value(to) - prior.value(from);
                    assert!((0.0..=1.0).contains(&from) && to <= 1.0 && span > 3.999);
                }
            }
        }
        for text in [
            "free=8..9",
            "free=8.5..60",
            "free=8..60.5",
            "free=50..53 log",
        ] {
            let message = of(text).unwrap_err().to_string();
            assert!(message.contains("whole number"), "{text}: {message}");
        }
        let pull = of("bond.pull=2..3 N").unwrap();
        assert_eq!(
            (pull.possible(0.123), pull.outward((0.1, 0.2))),
            (0.123, (0.1, 0.2))
        );
    }

    #[test]
    fn rejects_invalid_ranges() {
        for text in [
            "free",
            "free=5",
            "free=9..5",
            "free=0..5 log",
            "=1..2",
            "free=50..600/6",
            "tick=1 ms..2 s",
        ] {
            assert!(Prior::parse(text).is_err(), "{text}");
        }
        let scene = built_in("hemisphere").unwrap();
        let message = prior("frei=1..2", &scene).unwrap_err().to_string();
        assert!(message.contains("free"), "{message}");
    }
}
