//! Units of the values of a scene, in powers of the base units.
mod meant;
mod written;

pub use meant::{UNITS, unit_meant};
pub use written::WrittenQuantity;

/// Powers of kilogram, metre, second, ampere and kelvin, and of the tick, the scene's own clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension(pub(in crate::scene) [i8; 6]);

const TURN: f64 = std::f64::consts::TAU;

/// The units that the grammar knows, each with its size in SI units and its dimension.
pub const BASES: [(&str, f64, Dimension); 21] = [
    ("m", 1.0, Dimension::LENGTH),
    ("g", 1e-3, Dimension::MASS),
    ("s", 1.0, Dimension::TIME),
    ("min", 60.0, Dimension::TIME),
    ("h", 3600.0, Dimension::TIME),
    ("Hz", 1.0, Dimension::RATE),
    ("N", 1.0, Dimension::FORCE),
    ("Pa", 1.0, Dimension::PRESSURE),
    ("J", 1.0, Dimension([1, 2, -2, 0, 0, 0])),
    ("W", 1.0, Dimension::POWER),
    ("L", 1e-3, Dimension([0, 3, 0, 0, 0, 0])),
    ("K", 1.0, Dimension::TEMPERATURE),
    ("A", 1.0, Dimension([0, 0, 0, 1, 0, 0])),
    ("T", 1.0, Dimension([1, 0, -2, -1, 0, 0])),
    ("V", 1.0, Dimension([1, 2, -3, -1, 0, 0])),
    ("rev", TURN, Dimension::NUMBER),
    ("rad", 1.0, Dimension::NUMBER),
    ("deg", TURN / 360.0, Dimension::NUMBER),
    ("ticks", 1.0, Dimension::TICKS),
    ("tick", 1.0, Dimension::TICKS),
    ("%", 1e-2, Dimension::NUMBER),
];

/// What may stand before a unit.
#[derive(Clone, Copy, Debug)]
pub struct Prefix {
    /// How it is written.
    pub sign: char,
    /// What it stands for.
    pub power: f64,
    /// Whether it is in common use, so that units are suggested with it.
    pub is_common: bool,
}

const fn prefix(sign: char, power: f64, is_common: bool) -> Prefix {
    Prefix {
        sign,
        power,
        is_common,
    }
}

/// The prefixes that the grammar knows, the most frequent first.
pub const PREFIXES: [Prefix; 11] = [
    prefix('m', 1e-3, true),
    prefix('k', 1e3, true),
    prefix('c', 1e-2, true),
    prefix('u', 1e-6, true),
    prefix('n', 1e-9, true),
    prefix('M', 1e6, true),
    prefix('G', 1e9, true),
    prefix('\u{b5}', 1e-6, false),
    // The Greek letter, which looks the same.
    prefix('\u{3bc}', 1e-6, false),
    prefix('p', 1e-12, false),
    prefix('f', 1e-15, false),
];

impl Dimension {
    fn times(self, other: Dimension, power: i8) -> Dimension {
        let mut powers = self.0;
        for (own, more) in powers.iter_mut().zip(other.0) {
            *own = own.saturating_add(more.saturating_mul(power));
        }
        Dimension(powers)
    }
}

/// A value in a unit, such as `[("N", 1), ("m", -1)]`, in SI units, with its dimension.
pub fn to_si<'a>(
    mut value: f64,
    unit: impl IntoIterator<Item = (&'a str, i8)>,
) -> (f64, Dimension) {
    let mut dimension = Dimension::NUMBER;
    for (symbol, power) in unit {
        let (scale, base) = factor(symbol);
        // One multiplication or division by a power of ten keeps `20cm` the nearest double to 0.2.
        let parts = scale.recip().round();
        if scale < 1.0 && (parts * scale - 1.0).abs() < 1e-9 {
            value /= parts.powi(i32::from(power));
        } else {
            value *= scale.powi(i32::from(power));
        }
        dimension = dimension.times(base, power);
    }
    (value, dimension)
}

/// The size in SI units and the dimension of a symbol that the grammar lets through.
fn factor(symbol: &str) -> (f64, Dimension) {
    if let Some(base) = base(symbol) {
        return base;
    }
    let Some(prefix) = symbol.chars().next() else {
        return (1.0, Dimension::NUMBER);
    };
    let (scale, dimension) = base(&symbol[prefix.len_utf8()..]).unwrap_or((1.0, Dimension::NUMBER));
    // A gram is the one base with a scale below one; its own kilo makes exactly one.
    if (prefix, symbol) == ('k', "kg") {
        return (1.0, dimension);
    }
    let power = PREFIXES.iter().find(|it| it.sign == prefix);
    (scale * power.map_or(1.0, |it| it.power), dimension)
}

fn base(symbol: &str) -> Option<(f64, Dimension)> {
    let known = BASES.iter().find(|(base, ..)| *base == symbol);
    known.map(|&(_, scale, dimension)| (scale, dimension))
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
