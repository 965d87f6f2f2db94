//! Kinds of quantities in a scene, with their names and units.
use super::dimensionless::BlockUnits;
use super::units::{Dimension, to_si};

/// Kind of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct QuantityKind {
    /// Dimension, possibly shared with other kinds.
    pub dimension: Dimension,
    /// Name in messages, with an example.
    pub noun: &'static str,
    /// SI unit of reported values. Empty for a dimensionless number.
    pub unit: &'static str,
    /// Unit of the kind in block units. The block length a, the mass m and the tick τ are 1.
    pub block_unit: &'static str,
    /// Conversion from SI to block units.
    pub in_block_units: fn(BlockUnits, f64) -> f64,
    /// SI unit in scene syntax. Every value can be written in it.
    si: &'static str,
    /// Units that can make a written value shorter, in order of preference.
    preferred: &'static [&'static str],
}

macro_rules! kinds {
    ($($name:ident $powers:tt $noun:literal, $unit:literal, $block_unit:literal $in_block_units:expr, $si:literal $preferred:tt;)*) => {
        impl Dimension {
            $(#[doc = concat!("Of ", $noun, ".")] pub const $name: Dimension = Dimension($powers);)*
        }

        impl QuantityKind {
            $(#[doc = concat!("Of ", $noun, ".")] pub const $name: QuantityKind = QuantityKind {
                dimension: Dimension::$name,
                noun: $noun,
                unit: $unit,
                block_unit: $block_unit,
                in_block_units: $in_block_units,
                si: $si,
                preferred: &$preferred,
            };)*
            pub(super) const ALL: &[QuantityKind] = &[$(QuantityKind::$name),*];
        }
    };
}

// Powers of kg, m, s, A, K and tick; noun; unit; unit and value in block units; units in a scene.
kinds! {
    NUMBER [0, 0, 0, 0, 0, 0] "a number without a unit", "", "" |_, value| value, "" [];
    ANGLE [0, 0, 0, 0, 0, 0] "an angle, such as `26 deg`", "rad", "rad" |_, value| value, "rad" ["deg"];
    TIME [0, 0, 1, 0, 0, 0] "a time, such as `20ms`", "s", "τ" BlockUnits::time, "s" ["s", "ms", "us"];
    TICKS [0, 0, 0, 0, 0, 1] "a number of ticks, such as `3 ticks`", "ticks", "τ" |_, value| value, "ticks" [];
    LENGTH [0, 1, 0, 0, 0, 0] "a length, such as `20cm`", "m", "a" BlockUnits::length, "m" ["m", "mm", "um", "nm"];
    MASS [1, 0, 0, 0, 0, 0] "a mass, such as `1kg`", "kg", "m" BlockUnits::mass, "kg" ["kg", "g", "mg", "ug", "ng"];
    INERTIA [1, 2, 0, 0, 0, 0] "a value of another kind", "kg m²", "m a²" BlockUnits::inertia, "kg m^2" [];
    SPEED [0, 1, -1, 0, 0, 0] "a speed, such as `0.4 m/s`", "m/s", "a/τ" BlockUnits::speed, "m/s" ["m/s", "mm/s", "um/s"];
    FORCE [1, 1, -2, 0, 0, 0] "a force, such as `15 N`", "N", "m a/τ²" BlockUnits::force, "N" ["N", "mN", "uN", "nN", "pN", "fN"];
    STIFFNESS [1, 0, -2, 0, 0, 0] "a stiffness, such as `25 N/m`", "N/m", "m/τ²" BlockUnits::stiffness, "N/m" ["N/m", "mN/m", "uN/m", "nN/m"];
    DAMPING [1, 0, -1, 0, 0, 0] "a damping, such as `5 N s/m`", "N s/m", "m/τ" BlockUnits::damping, "N s/m" ["N s/m", "mN s/m", "uN s/m"];
    RATE [0, 0, -1, 0, 0, 0] "a rate, such as `0.5 s^-1` or `2 rev/s`", "1/s", "1/τ" BlockUnits::rate, "s^-1" [];
    TURNS [0, 0, -1, 0, 0, 0] "a rate, such as `0.5 s^-1` or `2 rev/s`", "1/s", "1/τ" BlockUnits::rate, "s^-1" ["rev/s"];
    ACCELERATION [0, 1, -2, 0, 0, 0] "an acceleration, such as `9.81 m/s^2`", "m/s²", "a/τ²" BlockUnits::acceleration, "m/s^2" [];
    DENSITY [1, -3, 0, 0, 0, 0] "a density, such as `920 kg/m^3`", "kg/m³", "m/a³" BlockUnits::density, "kg/m^3" [];
    PRESSURE [1, -1, -2, 0, 0, 0] "a pressure, such as `2 kPa`", "Pa", "m/(a τ²)" BlockUnits::pressure, "Pa" ["Pa", "kPa"];
    VISCOSITY [1, -1, -1, 0, 0, 0] "a viscosity, such as `60 mPa s`", "Pa s", "m/(a τ)" BlockUnits::viscosity, "Pa s" ["Pa s", "mPa s"];
    FLOW [0, 3, -1, 0, 0, 0] "a flow, such as `94.5 L/min`", "m³/s", "a³/τ" BlockUnits::flow, "m^3/s" ["L/min"];
    RESISTANCE [1, -4, -1, 0, 0, 0] "a hydraulic resistance, such as `5 kPa s/L`", "Pa s/m³", "m/(a⁴ τ)" BlockUnits::resistance, "Pa s/m^3" ["Pa s/L", "kPa s/L"];
    IMPULSE [1, 1, -1, 0, 0, 0] "an impulse, such as `0.3 N s`", "N s", "m a/τ" BlockUnits::impulse, "N s" ["N s", "mN s", "uN s"];
    TORQUE [1, 2, -2, 0, 0, 0] "a torque, such as `0.5 N m`", "N m", "m a²/τ²" BlockUnits::energy, "N m" ["N m", "mN m", "uN m", "nN m", "pN m"];
    TEMPERATURE [0, 0, 0, 0, 1, 0] "a temperature, such as `293 K`", "K", "K" |_, value| value, "K" [];
    POWER [1, 2, -3, 0, 0, 0] "a value of another kind", "W", "m a²/τ³" BlockUnits::power, "W" [];
    DIFFUSION [0, 2, -1, 0, 0, 0] "a value of another kind", "m²/s", "a²/τ" BlockUnits::diffusion, "m^2/s" [];
}

impl Dimension {
    /// Returns the name in messages, with an example.
    pub fn noun(self) -> &'static str {
        let known = (QuantityKind::ALL.iter()).find(|kind| kind.dimension == self);
        known.map_or("a value of another kind", |kind| kind.noun)
    }
}

/// Largest number of digits of a value with a preferred unit. Values with more digits are written
/// in the SI unit.
const CHOSEN: usize = 8;

/// Relative error allowed for a conversion between units.
const ROUNDING: f64 = 1e-15;

impl QuantityKind {
    /// Returns the unit of the example in the noun. Empty for a number.
    pub fn example_unit(&self) -> &'static str {
        let example = self.noun.split('`').nth(1).unwrap_or_default();
        example.trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | ' '))
    }

    pub(super) fn units(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        self.preferred.iter().copied().chain([self.si])
    }

    /// Writes a value in SI units as source text, in the unit that makes it short. Reading the text
    /// gives the value within the rounding error of the conversion.
    pub fn write(&self, value: f64) -> String {
        let chosen = |rounding: f64| {
            let preferred = self.preferred.iter().find_map(|&unit| {
                let number = shortest(value, unit, rounding)?;
                // Zero fits any unit, and angles are written in degrees of any size.
                let fits = value == 0.0 || unit == "deg" || (0.1..1000.0).contains(&number.abs());
                fits.then(|| text(number, unit))
            });
            preferred.or_else(|| Some(text(shortest(value, self.si, rounding)?, self.si)))
        };
        let short = chosen(0.0).or_else(|| chosen(ROUNDING));
        short.unwrap_or_else(|| text(value, self.si))
    }
}

fn text(number: f64, unit: &str) -> String {
    let number = format!("{number:?}");
    let number = number.strip_suffix(".0").unwrap_or(&number);
    format!("{number} {unit}").trim_end().to_owned()
}

/// Returns the shortest number with up to [`CHOSEN`] digits that equals `value` in a unit.
/// `rounding` is the allowed relative error. Returns `None` if there is no such number.
fn shortest(value: f64, unit: &str, rounding: f64) -> Option<f64> {
    let in_si = |value: f64| to_si(value, factors(unit)).0;
    let about = value / in_si(1.0);
    (0..CHOSEN)
        .filter_map(|digits| format!("{about:.digits$e}").parse().ok())
        .find(|&number| (in_si(number) - value).abs() <= rounding * value.abs())
}

/// Returns the factors of a unit such as `N s/m^2`, each with its power.
fn factors(unit: &str) -> impl Iterator<Item = (&str, i8)> {
    unit.split_whitespace().flat_map(|product| {
        (product.split('/').enumerate()).map(|(i, factor)| {
            let (symbol, power) = factor.split_once('^').unwrap_or((factor, "1"));
            let power: i8 = power.parse().unwrap_or(1);
            (symbol, if i == 0 { power } else { -power })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that values in any unit of a kind are read back within rounding, with few digits.
    #[test]
    fn a_short_number_in_any_unit_is_written_as_a_short_number() {
        let kinds: [(QuantityKind, &[&str]); 12] = [
            (QuantityKind::TIME, &["ms", "us", "min", "h"]),
            (QuantityKind::LENGTH, &["cm", "mm", "um", "km"]),
            (QuantityKind::MASS, &["g", "mg", "ng", "kg"]),
            (QuantityKind::SPEED, &["cm/s", "um/s", "km/h", "m/min"]),
            (QuantityKind::FORCE, &["mN", "pN", "g m/s^2"]),
            (QuantityKind::STIFFNESS, &["N/cm", "pN/um"]),
            (QuantityKind::DAMPING, &["mN s/mm", "kg/s"]),
            (QuantityKind::DENSITY, &["g/cm^3", "kg/L", "mg/mm^3", "g/L"]),
            (QuantityKind::VISCOSITY, &["mPa s", "uPa s"]),
            (QuantityKind::PRESSURE, &["kPa", "mPa", "N/cm^2"]),
            (QuantityKind::FLOW, &["L/min", "mL/s", "m^3/h"]),
            (QuantityKind::RESISTANCE, &["kPa s/L", "Pa h/m^3"]),
        ];
        for (kind, units) in kinds {
            for unit in units {
                for value in [1.0, 2.5, 7.0, 0.3, 1.018, 94.5, 920.05, 33.0, 0.07] {
                    let (si, dimension) = to_si(value, factors(unit));
                    assert_eq!(dimension, kind.dimension, "{unit}");
                    let written = kind.write(si);
                    let (number, _) = written.split_once(' ').unwrap();
                    let digits = number.split('e').next().unwrap();
                    let digits = digits.chars().filter(char::is_ascii_digit).count();
                    // Minutes and hours are not decimal fractions of a second.
                    let is_decimal =
                        factors(unit).all(|(symbol, _)| !["min", "h"].contains(&symbol));
                    let spelling = format!("{value} {unit} is written as {written}");
                    assert!(!is_decimal || digits <= 10, "{spelling}");
                    assert!(!number.contains("0000000"), "{spelling}");
                    assert!(!number.contains("9999999"), "{spelling}");
                }
            }
        }
        assert_eq!(
            QuantityKind::DENSITY.write(1000.0000000000001),
            "1000 kg/m^3"
        );
        assert_eq!(QuantityKind::NUMBER.write(0.1 + 0.2), "0.3");
    }

    #[test]
    fn the_units_of_a_kind_have_its_dimension() {
        for kind in QuantityKind::ALL {
            for unit in kind.units() {
                assert_eq!(to_si(1.0, factors(unit)).1, kind.dimension, "{unit}");
            }
        }
    }
}
