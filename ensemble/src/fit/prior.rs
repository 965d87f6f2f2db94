//! What is known of a number before: it is between two values, each as likely as any other.
use stochc_ir::scene::Scene;

use crate::Varied;
use crate::sweep::{common, digits, logarithmic, number, value, varied};

/// A number of a scene and its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Its name, such as `bond.pull`.
    pub of: String,
    /// The lower end, in `unit`.
    pub from: f64,
    /// The upper end, in `unit`.
    pub to: f64,
    /// As it was given; empty: none.
    pub unit: String,
    /// Whether its logarithm is evenly distributed, and not the number itself.
    pub is_logarithmic: bool,
}

impl Prior {
    /// Reads `NAME=FROM..TO`, such as `bond.pull=2..12 N` or `drag.rate=0.1..10 /s log`.
    ///
    /// # Errors
    /// In words; whether a scene has the number is another matter.
    pub fn parse(text: &str) -> Result<Prior, String> {
        let wrong = "write NAME=FROM..TO, such as `bond.pull=2..12 N` or `free=50..500 log`";
        let (name, range) = text.split_once('=').ok_or(wrong)?;
        let (range, is_logarithmic) = logarithmic(range);
        let (from, to) = range.split_once("..").ok_or(wrong)?;
        if name.trim().is_empty() || to.contains('/') && to.rsplit('/').next().is_some_and(is_count)
        {
            return Err(wrong.to_owned());
        }
        let ends = [value(from)?, value(to)?];
        let unit = common(&ends)?;
        let [from, to] = ends.map(|(end, _)| end);
        if from >= to || !(from.is_finite() && to.is_finite()) {
            return Err(format!(
                "`{from}..{to}` is no range: the first end has to be the lower one"
            ));
        }
        if is_logarithmic && from <= 0.0 {
            return Err("a range with `log` is of values above 0".to_owned());
        }
        Ok(Prior {
            of: name.trim().to_owned(),
            from,
            to,
            unit,
            is_logarithmic,
        })
    }

    /// The value at a part of the prior's probability, 0 to 1, in `unit`.
    pub fn value(&self, share: f64) -> f64 {
        match self.is_logarithmic {
            true => self.from * (self.to / self.from).powf(share),
            false => self.from + (self.to - self.from) * share,
        }
    }

    /// The value there, for a scene.
    ///
    /// # Errors
    /// In words, when the scene has no such number, or may not have this value of it.
    pub fn varied(&self, share: f64, scene: &Scene) -> Result<Varied, String> {
        let number = number(scene, &self.of)?;
        let said = self.value(share);
        let said = match number.is_whole() {
            true => said.round(),
            // As many digits as single precision has: more would make no other run.
            false => digits(said, 7),
        };
        varied(number, said, &self.unit)
    }
}

/// `6`, which a sweep would read as a number of values.
fn is_count(text: &str) -> bool {
    !text.trim().is_empty() && text.trim().chars().all(|c| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use stochc_compiler::scene::built_in;

    use super::*;

    #[test]
    fn a_range_is_read_with_its_unit() {
        let prior = Prior::parse("bond.pull = 2..12 N").unwrap();
        assert_eq!((prior.from, prior.to, &*prior.unit), (2.0, 12.0, "N"));
        assert!((prior.value(0.25) - 4.5).abs() < 1e-12);
        let prior = Prior::parse("free=50..5000 log").unwrap();
        assert!(prior.is_logarithmic);
        let scene = built_in("hemisphere").unwrap();
        let varied = prior.varied(0.5, &scene).unwrap();
        assert_eq!((varied.of.as_str(), varied.said), ("free", 500.0));
    }

    #[test]
    fn what_is_no_range_is_refused() {
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
        let told = Prior::parse("frei=1..2")
            .unwrap()
            .varied(0.5, &scene)
            .unwrap_err();
        assert!(told.contains("free"), "{told}");
    }
}
