//! Units and dimensions of the values of a scene.

/// Powers of kilogram, metre, second, ampere and kelvin, and of the tick, the scene's own clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension {
    kilogram: i8,
    metre: i8,
    second: i8,
    ampere: i8,
    kelvin: i8,
    tick: i8,
}

const NONE: Dimension = Dimension {
    kilogram: 0,
    metre: 0,
    second: 0,
    ampere: 0,
    kelvin: 0,
    tick: 0,
};

impl Dimension {
    /// A pure number; angles are pure numbers, in radians.
    pub const NUMBER: Dimension = NONE;
    /// \[s\]
    pub const TIME: Dimension = Dimension { second: 1, ..NONE };
    /// \[m\]
    pub const LENGTH: Dimension = Dimension { metre: 1, ..NONE };
    /// \[kg\]
    pub const MASS: Dimension = Dimension {
        kilogram: 1,
        ..NONE
    };
    /// \[m/s\]
    pub const SPEED: Dimension = Dimension {
        metre: 1,
        second: -1,
        ..NONE
    };
    /// \[N\]
    pub const FORCE: Dimension = Dimension {
        kilogram: 1,
        metre: 1,
        second: -2,
        ..NONE
    };
    /// \[N/m\]
    pub const STIFFNESS: Dimension = Dimension {
        kilogram: 1,
        second: -2,
        ..NONE
    };
    /// \[N s/m\]
    pub const DAMPING: Dimension = Dimension {
        kilogram: 1,
        second: -1,
        ..NONE
    };
    /// \[1/s\]
    pub const RATE: Dimension = Dimension { second: -1, ..NONE };
    /// \[m/s^2\]
    pub const ACCELERATION: Dimension = Dimension {
        metre: 1,
        second: -2,
        ..NONE
    };
    /// \[kg/m^3\]
    pub const DENSITY: Dimension = Dimension {
        kilogram: 1,
        metre: -3,
        ..NONE
    };
    /// \[Pa\]
    pub const PRESSURE: Dimension = Dimension {
        kilogram: 1,
        metre: -1,
        second: -2,
        ..NONE
    };
    /// \[Pa s\]
    pub const VISCOSITY: Dimension = Dimension {
        kilogram: 1,
        metre: -1,
        second: -1,
        ..NONE
    };
    /// \[m^3/s\]
    pub const FLOW: Dimension = Dimension {
        metre: 3,
        second: -1,
        ..NONE
    };
    /// \[Pa s/m^3\]
    pub const RESISTANCE: Dimension = Dimension {
        kilogram: 1,
        metre: -4,
        second: -1,
        ..NONE
    };
    /// \[N s\]
    pub const IMPULSE: Dimension = Dimension {
        kilogram: 1,
        metre: 1,
        second: -1,
        ..NONE
    };
    /// \[K\]
    pub const TEMPERATURE: Dimension = Dimension { kelvin: 1, ..NONE };
    /// Ticks of the scene's clock.
    pub const TICKS: Dimension = Dimension { tick: 1, ..NONE };

    /// What messages call it, with a unit as an example.
    pub fn noun(self) -> &'static str {
        match self {
            Dimension::NUMBER => "a number without a unit",
            Dimension::TIME => "a time, such as `20ms`",
            Dimension::LENGTH => "a length, such as `20cm`",
            Dimension::MASS => "a mass, such as `1kg`",
            Dimension::SPEED => "a speed, such as `0.4 m/s`",
            Dimension::FORCE => "a force, such as `15 N`",
            Dimension::STIFFNESS => "a stiffness, such as `25 N/m`",
            Dimension::DAMPING => "a damping, such as `5 N s/m`",
            Dimension::RATE => "a rate, such as `0.5 s^-1` or `2 rev/s`",
            Dimension::ACCELERATION => "an acceleration, such as `9.81 m/s^2`",
            Dimension::DENSITY => "a density, such as `920 kg/m^3`",
            Dimension::PRESSURE => "a pressure, such as `2 kPa`",
            Dimension::VISCOSITY => "a viscosity, such as `60 mPa s`",
            Dimension::FLOW => "a flow, such as `94.5 L/min`",
            Dimension::RESISTANCE => "a hydraulic resistance, such as `5 kPa s/L`",
            Dimension::IMPULSE => "an impulse, such as `0.3 N s`",
            Dimension::TEMPERATURE => "a temperature, such as `293 K`",
            Dimension::TICKS => "a number of ticks, such as `3 ticks`",
            _ => "a value of another kind",
        }
    }

    fn times(self, other: Dimension, power: i8) -> Dimension {
        let add = |a: i8, b: i8| a.saturating_add(b.saturating_mul(power));
        Dimension {
            kilogram: add(self.kilogram, other.kilogram),
            metre: add(self.metre, other.metre),
            second: add(self.second, other.second),
            ampere: add(self.ampere, other.ampere),
            kelvin: add(self.kelvin, other.kelvin),
            tick: add(self.tick, other.tick),
        }
    }
}

/// A value in a unit, such as `[("N", 1), ("m", -1)]`, in SI units, with its dimension.
pub fn to_si<'a>(
    mut value: f64,
    unit: impl IntoIterator<Item = (&'a str, i8)>,
) -> (f64, Dimension) {
    let mut dimension = NONE;
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
        return (1.0, NONE);
    };
    let (scale, dimension) = base(&symbol[prefix.len_utf8()..]).unwrap_or((1.0, NONE));
    // A gram is the one base with a scale below one; its own kilo makes exactly one.
    if (prefix, symbol) == ('k', "kg") {
        return (1.0, dimension);
    }
    let power = match prefix {
        'f' => 1e-15,
        'p' => 1e-12,
        'n' => 1e-9,
        'u' | 'µ' => 1e-6,
        'm' => 1e-3,
        'c' => 1e-2,
        'k' => 1e3,
        'M' => 1e6,
        _ => 1e9,
    };
    (scale * power, dimension)
}

fn base(symbol: &str) -> Option<(f64, Dimension)> {
    const ENERGY: Dimension = Dimension {
        kilogram: 1,
        metre: 2,
        second: -2,
        ..NONE
    };
    const TURN: f64 = std::f64::consts::TAU;
    Some(match symbol {
        "m" => (1.0, Dimension::LENGTH),
        "g" => (1e-3, Dimension::MASS),
        "s" => (1.0, Dimension::TIME),
        "min" => (60.0, Dimension::TIME),
        "h" => (3600.0, Dimension::TIME),
        "Hz" => (1.0, Dimension::RATE),
        "N" => (1.0, Dimension::FORCE),
        "Pa" => (1.0, Dimension::PRESSURE),
        "J" => (1.0, ENERGY),
        "W" => (1.0, ENERGY.times(Dimension::TIME, -1)),
        "L" => (1e-3, Dimension { metre: 3, ..NONE }),
        "K" => (1.0, Dimension { kelvin: 1, ..NONE }),
        "A" => (1.0, Dimension { ampere: 1, ..NONE }),
        "T" => (
            1.0,
            Dimension {
                kilogram: 1,
                second: -2,
                ampere: -1,
                ..NONE
            },
        ),
        "V" => (
            1.0,
            ENERGY.times(
                Dimension {
                    second: 1,
                    ampere: 1,
                    ..NONE
                },
                -1,
            ),
        ),
        "rev" => (TURN, NONE),
        "rad" => (1.0, NONE),
        "deg" => (TURN / 360.0, NONE),
        "%" => (1e-2, NONE),
        "tick" | "ticks" => (1.0, Dimension::TICKS),
        _ => return None,
    })
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
        assert_eq!(
            dimension,
            Dimension {
                metre: 3,
                second: -1,
                ..NONE
            }
        );
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
