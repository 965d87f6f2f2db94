//! Dimensions, base units and prefixes.
use super::scale::Scale;

/// Powers of kilogram, metre, second, ampere, kelvin and tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension(pub(in crate::scene) [i8; 6]);

/// Units that the grammar reads, each with its size in SI units and its dimension.
pub const BASES: [(&str, Scale, Dimension); 24] = [
    ("m", Scale::ONE, Dimension::LENGTH),
    ("g", Scale::ONE.tens(-3), Dimension::MASS),
    ("s", Scale::ONE, Dimension::TIME),
    ("min", Scale::SIXTY, Dimension::TIME),
    ("h", Scale::SIXTY.times(Scale::SIXTY, 1), Dimension::TIME),
    ("Hz", Scale::ONE, Dimension::RATE),
    ("rpm", Scale::TURN.times(Scale::SIXTY, -1), Dimension::RATE),
    ("N", Scale::ONE, Dimension::FORCE),
    ("Pa", Scale::ONE, Dimension::PRESSURE),
    ("bar", Scale::ONE.tens(5), Dimension::PRESSURE),
    ("P", Scale::ONE.tens(-1), Dimension::VISCOSITY),
    ("J", Scale::ONE, Dimension([1, 2, -2, 0, 0, 0])),
    ("W", Scale::ONE, Dimension::POWER),
    ("L", Scale::ONE.tens(-3), Dimension([0, 3, 0, 0, 0, 0])),
    ("K", Scale::ONE, Dimension::TEMPERATURE),
    ("A", Scale::ONE, Dimension([0, 0, 0, 1, 0, 0])),
    ("T", Scale::ONE, Dimension([1, 0, -2, -1, 0, 0])),
    ("V", Scale::ONE, Dimension([1, 2, -3, -1, 0, 0])),
    ("rev", Scale::TURN, Dimension::NUMBER),
    ("rad", Scale::ONE, Dimension::NUMBER),
    (
        "deg",
        Scale::TURN.times(Scale::SIXTY, -2).tens(1),
        Dimension::NUMBER,
    ),
    ("ticks", Scale::ONE, Dimension::TICKS),
    ("tick", Scale::ONE, Dimension::TICKS),
    ("%", Scale::ONE.tens(-2), Dimension::NUMBER),
];

/// Prefix of a unit.
#[derive(Clone, Copy, Debug)]
pub struct Prefix {
    /// Character of the prefix.
    pub sign: char,
    /// Power of ten.
    pub power: i32,
    /// Whether the prefix is common, so that suggestions include it.
    pub is_common: bool,
}

pub(super) const fn prefix(sign: char, power: i32, is_common: bool) -> Prefix {
    Prefix {
        sign,
        power,
        is_common,
    }
}

/// Prefixes that the grammar reads, the most common first.
pub const PREFIXES: [Prefix; 11] = [
    prefix('m', -3, true),
    prefix('k', 3, true),
    prefix('c', -2, true),
    prefix('u', -6, true),
    prefix('n', -9, true),
    prefix('M', 6, true),
    prefix('G', 9, true),
    prefix('\u{b5}', -6, false),
    // The Greek letter, which looks the same.
    prefix('\u{3bc}', -6, false),
    prefix('p', -12, false),
    prefix('f', -15, false),
];

impl Dimension {
    pub(super) fn times(self, other: Dimension, power: i8) -> Dimension {
        let mut powers = self.0;
        for (own, more) in powers.iter_mut().zip(other.0) {
            *own = own.saturating_add(more.saturating_mul(power));
        }
        Dimension(powers)
    }
}

/// Converts a value in a unit, such as `[("N", 1), ("m", -1)]`, to SI units. Returns it with its
/// dimension.
pub fn to_si<'a>(value: f64, unit: impl IntoIterator<Item = (&'a str, i8)>) -> (f64, Dimension) {
    let (mut scale, mut dimension) = (Scale::ONE, Dimension::NUMBER);
    for (symbol, power) in unit {
        let (size, base) = factor(symbol);
        scale = scale.times(size, i32::from(power));
        dimension = dimension.times(base, power);
    }
    (scale.apply(value), dimension)
}

/// Returns the size in SI units and the dimension of a valid symbol.
pub(super) fn factor(symbol: &str) -> (Scale, Dimension) {
    let base = |symbol: &str| {
        let known = BASES.iter().find(|(base, ..)| *base == symbol);
        known.map(|&(_, size, dimension)| (size, dimension))
    };
    let prefixed = || {
        let prefix = PREFIXES.iter().find(|it| symbol.starts_with(it.sign))?;
        let (size, dimension) = base(&symbol[prefix.sign.len_utf8()..])?;
        Some((size.tens(prefix.power), dimension))
    };
    let known = base(symbol).or_else(prefixed);
    known.unwrap_or((Scale::ONE, Dimension::NUMBER))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn si(value: f64, unit: &[(&str, i8)]) -> (f64, Dimension) {
        to_si(value, unit.iter().copied())
    }

    #[test]
    fn units_have_their_size_and_dimension() {
        assert_eq!(si(20.0, &[("cm", 1)]), (0.2, Dimension::LENGTH));
        assert_eq!(si(20.0, &[("ms", 1)]), (0.02, Dimension::TIME));
        assert_eq!(si(1.0, &[("kg", 1)]), (1.0, Dimension::MASS));
        assert_eq!(si(2.5, &[("g", 1)]), (0.0025, Dimension::MASS));
        assert_eq!(si(1.0, &[("mm", 1)]), (0.001, Dimension::LENGTH));
        assert_eq!(
            si(3.0, &[("kg", 1), ("m", 1), ("s", -2)]),
            (3.0, Dimension::FORCE)
        );
        let (flow, dimension) = si(60.0, &[("L", 1), ("min", -1)]);
        assert!((flow - 1e-3).abs() < 1e-18);
        assert_eq!(dimension, Dimension::FLOW);
        for damping in [
            si(5.0, &[("N", 1), ("s", 1), ("m", -1)]),
            si(5.0, &[("kg", 1), ("s", -1)]),
        ] {
            assert_eq!(damping, (5.0, Dimension::DAMPING));
        }
        let (viscosity, _) = si(100.0, &[("mPa", 1), ("s", 1)]);
        assert!((viscosity - 0.1).abs() < 1e-15);
        assert!((si(180.0, &[("deg", 1)]).0 - std::f64::consts::PI).abs() < 1e-15);
        assert!((si(1.0, &[("mmin", 1)]).0 - 0.06).abs() < 1e-15);
    }
}
