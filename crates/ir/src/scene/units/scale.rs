//! Exact sizes of units.
use std::f64::consts::TAU;

/// Size of a unit in SI units: 6^`sixes` 10^`tens` (2π)^`turns`. All units are such products, so no
/// size is rounded before it is applied to a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scale {
    sixes: i32,
    tens: i32,
    turns: i32,
}

/// Unevaluated sum with twice the precision of a double.
#[derive(Clone, Copy)]
struct DoubleDouble {
    high: f64,
    low: f64,
}

/// Largest exponent of a power of 6 or 10 that is applied at once. Doubles represent these powers
/// exactly.
const MAX_STEP: u32 = 20;

impl Scale {
    pub(super) const ONE: Scale = Scale {
        sixes: 0,
        tens: 0,
        turns: 0,
    };
    pub(super) const SIXTY: Scale = Scale {
        sixes: 1,
        tens: 1,
        turns: 0,
    };
    pub(super) const TURN: Scale = Scale {
        sixes: 0,
        tens: 0,
        turns: 1,
    };

    /// Returns this scale multiplied by a power of ten.
    pub(super) const fn tens(self, power: i32) -> Scale {
        Scale {
            tens: self.tens.saturating_add(power),
            ..self
        }
    }

    /// Returns this scale multiplied by a power of another scale.
    pub(super) const fn times(self, other: Scale, power: i32) -> Scale {
        Scale {
            sixes: self.sixes.saturating_add(other.sixes.saturating_mul(power)),
            tens: self.tens.saturating_add(other.tens.saturating_mul(power)),
            turns: self.turns.saturating_add(other.turns.saturating_mul(power)),
        }
    }

    /// Converts a value in this unit to SI units. The result is the nearest double. If the unit
    /// contains factors of 2π, the result is rounded a second time.
    pub(super) fn apply(self, value: f64) -> f64 {
        match self.turns {
            0 => self.times_decimal(value),
            turns => value * self.times_decimal(TAU.powi(turns)),
        }
    }

    fn times_decimal(self, value: f64) -> f64 {
        let value = DoubleDouble {
            high: value,
            low: 0.0,
        };
        let product = value.scaled(6.0, self.sixes).scaled(10.0, self.tens);
        product.nearest()
    }
}

impl DoubleDouble {
    fn scaled(mut self, base: f64, power: i32) -> DoubleDouble {
        let mut left = power.unsigned_abs();
        // Zero and infinity do not change.
        while left > 0 && self.high.is_finite() && self.high != 0.0 {
            let step = left.min(MAX_STEP);
            let factor = base.powi(step as i32);
            self = if power > 0 {
                self.times(factor)
            } else {
                self.divided_by(factor)
            };
            left -= step;
        }
        self
    }

    fn times(self, factor: f64) -> DoubleDouble {
        let high = self.high * factor;
        let low = self.high.mul_add(factor, -high) + self.low * factor;
        DoubleDouble { high, low }
    }

    fn divided_by(self, divisor: f64) -> DoubleDouble {
        let high = self.high / divisor;
        let low = (high.mul_add(-divisor, self.high) + self.low) / divisor;
        DoubleDouble { high, low }
    }

    fn nearest(self) -> f64 {
        let sum = self.high + self.low;
        // Beyond the range of doubles the correction is meaningless.
        if sum.is_finite() { sum } else { self.high }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BASES, PREFIXES, to_si};
    use super::*;

    /// Expected sizes of units: numerator, denominator, and number of factors 2π.
    const SIZES: [(&str, u128, u128, u32); 24] = [
        ("m", 1, 1, 0),
        ("g", 1, 1000, 0),
        ("s", 1, 1, 0),
        ("min", 60, 1, 0),
        ("h", 3600, 1, 0),
        ("Hz", 1, 1, 0),
        ("rpm", 1, 60, 1),
        ("N", 1, 1, 0),
        ("Pa", 1, 1, 0),
        ("bar", 100_000, 1, 0),
        ("P", 1, 10, 0),
        ("J", 1, 1, 0),
        ("W", 1, 1, 0),
        ("L", 1, 1000, 0),
        ("K", 1, 1, 0),
        ("A", 1, 1, 0),
        ("T", 1, 1, 0),
        ("V", 1, 1, 0),
        ("rev", 1, 1, 1),
        ("rad", 1, 1, 0),
        ("deg", 1, 360, 1),
        ("ticks", 1, 1, 0),
        ("tick", 1, 1, 0),
        ("%", 1, 100, 0),
    ];

    /// Powers of ten as fractions.
    const POWERS: [(char, u128, u128); 11] = [
        ('m', 1, 1000),
        ('k', 1000, 1),
        ('c', 1, 100),
        ('u', 1, 1_000_000),
        ('n', 1, 1_000_000_000),
        ('M', 1_000_000, 1),
        ('G', 1_000_000_000, 1),
        ('\u{b5}', 1, 1_000_000),
        ('\u{3bc}', 1, 1_000_000),
        ('p', 1, 1_000_000_000_000),
        ('f', 1, 1_000_000_000_000_000),
    ];

    /// Returns the double nearest to a fraction, by long division.
    fn nearest(numerator: u128, denominator: u128) -> f64 {
        let (mut whole, mut rest) = (numerator / denominator, numerator % denominator);
        let mut exponent = 0;
        // Two bits more than a double, and whether the rest is zero, determine the rounding.
        while whole < 1 << 54 {
            rest *= 2;
            whole = whole * 2 + rest / denominator;
            rest %= denominator;
            exponent -= 1;
        }
        (whole | u128::from(rest > 0)) as f64 * 2_f64.powi(exponent)
    }

    #[test]
    fn every_unit_with_every_prefix_agrees_with_rational_arithmetic() {
        assert_eq!(
            SIZES.map(|(symbol, ..)| symbol),
            BASES.map(|(symbol, ..)| symbol)
        );
        assert_eq!(
            POWERS.map(|(sign, ..)| sign),
            PREFIXES.map(|prefix| prefix.sign)
        );
        // 2π as a double is an integer multiple of 2^-50.
        let turn = (TAU * 2_f64.powi(50)) as u128;
        for (symbol, numerator, denominator, turns) in SIZES {
            let with = |&(sign, times, by): &(char, u128, u128)| {
                let unit = format!("{sign}{symbol}");
                (unit, numerator * times, denominator * by)
            };
            let plain = (symbol.to_owned(), numerator, denominator);
            for (unit, numerator, denominator) in POWERS.iter().map(with).chain([plain]) {
                let known = BASES.iter().any(|(base, ..)| *base == unit);
                if known && unit != symbol {
                    continue;
                }
                if turns == 1 {
                    let size = nearest(numerator * turn, denominator << 50);
                    assert_eq!(to_si(1.0, [(&*unit, 1)]).0, size, "1 {unit}");
                    continue;
                }
                for value in [1_u128, 7, 20, 945] {
                    let si = |power| to_si(value as f64, [(&*unit, power)]).0;
                    let size = nearest(value * numerator, denominator);
                    assert_eq!(si(1), size, "{value} {unit}");
                    let size = nearest(value * denominator, numerator);
                    assert_eq!(si(-1), size, "{value} {unit}^-1");
                    let size = nearest(value * numerator.pow(2), denominator.pow(2));
                    assert_eq!(si(2), size, "{value} {unit}^2");
                }
            }
        }
    }

    #[test]
    fn values_beyond_doubles_are_zero_or_infinite() {
        assert_eq!(to_si(1e300, [("km", 99)]).0, f64::INFINITY);
        assert_eq!(to_si(1e300, [("mm", 99), ("fs", 99)]).0, 0.0);
        assert_eq!(to_si(0.0, [("km", 99)]).0, 0.0);
        assert_eq!(to_si(1e-310, [("Gm", 1)]).0, 1e-310 * 1e9);
    }
}
