//! Values as they are written in a scene.
use super::super::units::to_si;

/// A unit: how it is written, and its factors.
type Unit = (&'static str, &'static [(&'static str, i8)]);

/// The units that values of one dimension are written in, the preferred first.
pub struct Units {
    /// Its SI unit, in which every value can be written.
    si: Unit,
    preferred: &'static [Unit],
}

pub const TIME: Units = Units {
    si: ("s", &[("s", 1)]),
    preferred: &[
        ("s", &[("s", 1)]),
        ("ms", &[("ms", 1)]),
        ("us", &[("us", 1)]),
    ],
};

pub const LENGTH: Units = Units {
    si: ("m", &[("m", 1)]),
    preferred: &[
        ("m", &[("m", 1)]),
        ("mm", &[("mm", 1)]),
        ("um", &[("um", 1)]),
        ("nm", &[("nm", 1)]),
    ],
};

pub const MASS: Units = Units {
    si: ("kg", &[("kg", 1)]),
    preferred: &[
        ("kg", &[("kg", 1)]),
        ("g", &[("g", 1)]),
        ("mg", &[("mg", 1)]),
        ("ug", &[("ug", 1)]),
        ("ng", &[("ng", 1)]),
    ],
};

pub const SPEED: Units = Units {
    si: ("m/s", &[("m", 1), ("s", -1)]),
    preferred: &[
        ("m/s", &[("m", 1), ("s", -1)]),
        ("mm/s", &[("mm", 1), ("s", -1)]),
        ("um/s", &[("um", 1), ("s", -1)]),
    ],
};

pub const FORCE: Units = Units {
    si: ("N", &[("N", 1)]),
    preferred: &[
        ("N", &[("N", 1)]),
        ("mN", &[("mN", 1)]),
        ("uN", &[("uN", 1)]),
        ("nN", &[("nN", 1)]),
        ("pN", &[("pN", 1)]),
        ("fN", &[("fN", 1)]),
    ],
};

pub const STIFFNESS: Units = Units {
    si: ("N/m", &[("N", 1), ("m", -1)]),
    preferred: &[
        ("N/m", &[("N", 1), ("m", -1)]),
        ("mN/m", &[("mN", 1), ("m", -1)]),
        ("uN/m", &[("uN", 1), ("m", -1)]),
        ("nN/m", &[("nN", 1), ("m", -1)]),
    ],
};

pub const DAMPING: Units = Units {
    si: ("N s/m", &[("N", 1), ("s", 1), ("m", -1)]),
    preferred: &[
        ("N s/m", &[("N", 1), ("s", 1), ("m", -1)]),
        ("mN s/m", &[("mN", 1), ("s", 1), ("m", -1)]),
        ("uN s/m", &[("uN", 1), ("s", 1), ("m", -1)]),
    ],
};

pub const RATE: Units = Units {
    si: ("s^-1", &[("s", -1)]),
    preferred: &[],
};

pub const TURNS: Units = Units {
    si: ("s^-1", &[("s", -1)]),
    preferred: &[("rev/s", &[("rev", 1), ("s", -1)])],
};

pub const ACCELERATION: Units = Units {
    si: ("m/s^2", &[("m", 1), ("s", -2)]),
    preferred: &[],
};

pub const DENSITY: Units = Units {
    si: ("kg/m^3", &[("kg", 1), ("m", -3)]),
    preferred: &[],
};

pub const VISCOSITY: Units = Units {
    si: ("Pa s", &[("Pa", 1), ("s", 1)]),
    preferred: &[
        ("Pa s", &[("Pa", 1), ("s", 1)]),
        ("mPa s", &[("mPa", 1), ("s", 1)]),
    ],
};

pub const PRESSURE: Units = Units {
    si: ("Pa", &[("Pa", 1)]),
    preferred: &[("Pa", &[("Pa", 1)]), ("kPa", &[("kPa", 1)])],
};

pub const FLOW: Units = Units {
    si: ("m^3/s", &[("m", 3), ("s", -1)]),
    preferred: &[("L/min", &[("L", 1), ("min", -1)])],
};

pub const RESISTANCE: Units = Units {
    si: ("Pa s/m^3", &[("Pa", 1), ("s", 1), ("m", -3)]),
    preferred: &[
        ("Pa s/L", &[("Pa", 1), ("s", 1), ("L", -1)]),
        ("kPa s/L", &[("kPa", 1), ("s", 1), ("L", -1)]),
    ],
};

pub const IMPULSE: Units = Units {
    si: ("N s", &[("N", 1), ("s", 1)]),
    preferred: &[
        ("N s", &[("N", 1), ("s", 1)]),
        ("mN s", &[("mN", 1), ("s", 1)]),
        ("uN s", &[("uN", 1), ("s", 1)]),
    ],
};

pub const TEMPERATURE: Units = Units {
    si: ("K", &[("K", 1)]),
    preferred: &[],
};

pub const ANGLE: Units = Units {
    si: ("rad", &[("rad", 1)]),
    preferred: &[("deg", &[("deg", 1)])],
};

pub const NUMBER: Units = Units {
    si: ("", &[]),
    preferred: &[],
};

/// More digits than this are no value that somebody has chosen in that unit.
const CHOSEN: usize = 8;

/// What the conversion of a unit into another one may change, as a share: some roundings.
const ROUNDING: f64 = 1e-15;

/// A value in SI units with a unit in which it is short; reads as the same value again, within the
/// rounding of the conversion: of what was written in another unit, as `1 g/cm^3`, more is not to be had.
pub fn write(value: f64, units: &Units) -> String {
    let chosen = |rounding: f64| {
        let preferred = units.preferred.iter().find_map(|&unit| {
            let number = shortest(value, unit, rounding)?;
            // A zero is one of any unit, and of an angle nobody minds how many degrees it has.
            let fits = value == 0.0 || unit.0 == "deg" || (0.1..1000.0).contains(&number.abs());
            fits.then(|| text(number, unit.0))
        });
        preferred.or_else(|| Some(text(shortest(value, units.si, rounding)?, units.si.0)))
    };
    let short = chosen(0.0).or_else(|| chosen(ROUNDING));
    short.unwrap_or_else(|| text(value, units.si.0))
}

fn text(number: f64, unit: &str) -> String {
    let number = format!("{number:?}");
    let number = number.strip_suffix(".0").unwrap_or(&number);
    format!("{number} {unit}").trim_end().to_owned()
}

/// The number with the fewest digits, up to [`CHOSEN`], that is `value` in a unit, but for a share of it.
fn shortest(value: f64, (_, factors): Unit, rounding: f64) -> Option<f64> {
    let in_si = |value: f64| to_si(value, factors.iter().copied()).0;
    let about = value / in_si(1.0);
    (0..CHOSEN)
        .filter_map(|digits| format!("{about:.digits$e}").parse().ok())
        .find(|&number| (in_si(number) - value).abs() <= rounding * value.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is written in any unit of its kind comes back in few digits, and within a rounding.
    #[test]
    fn a_short_number_in_any_unit_is_written_as_a_short_number() {
        type Written = (&'static Units, &'static [&'static [(&'static str, i8)]]);
        let kinds: [Written; 12] = [
            (
                &TIME,
                &[&[("ms", 1)], &[("us", 1)], &[("min", 1)], &[("h", 1)]],
            ),
            (
                &LENGTH,
                &[&[("cm", 1)], &[("mm", 1)], &[("um", 1)], &[("km", 1)]],
            ),
            (
                &MASS,
                &[&[("g", 1)], &[("mg", 1)], &[("ng", 1)], &[("kg", 1)]],
            ),
            (
                &SPEED,
                &[
                    &[("cm", 1), ("s", -1)],
                    &[("um", 1), ("s", -1)],
                    &[("km", 1), ("h", -1)],
                    &[("m", 1), ("min", -1)],
                ],
            ),
            (
                &FORCE,
                &[&[("mN", 1)], &[("pN", 1)], &[("g", 1), ("m", 1), ("s", -2)]],
            ),
            (
                &STIFFNESS,
                &[&[("N", 1), ("cm", -1)], &[("pN", 1), ("um", -1)]],
            ),
            (
                &DAMPING,
                &[&[("mN", 1), ("s", 1), ("mm", -1)], &[("kg", 1), ("s", -1)]],
            ),
            (
                &DENSITY,
                &[
                    &[("g", 1), ("cm", -3)],
                    &[("kg", 1), ("L", -1)],
                    &[("mg", 1), ("mm", -3)],
                    &[("g", 1), ("L", -1)],
                ],
            ),
            (
                &VISCOSITY,
                &[&[("mPa", 1), ("s", 1)], &[("uPa", 1), ("s", 1)]],
            ),
            (
                &PRESSURE,
                &[&[("kPa", 1)], &[("mPa", 1)], &[("N", 1), ("cm", -2)]],
            ),
            (
                &FLOW,
                &[
                    &[("L", 1), ("min", -1)],
                    &[("mL", 1), ("s", -1)],
                    &[("m", 3), ("h", -1)],
                ],
            ),
            (
                &RESISTANCE,
                &[
                    &[("kPa", 1), ("s", 1), ("L", -1)],
                    &[("Pa", 1), ("h", 1), ("m", -3)],
                ],
            ),
        ];
        for (units, spellings) in kinds {
            for factors in spellings {
                for value in [1.0, 2.5, 7.0, 0.3, 1.018, 94.5, 920.05, 33.0, 0.07] {
                    let (si, _) = to_si(value, factors.iter().copied());
                    let told = write(si, units);
                    let (number, _) = told.split_once(' ').unwrap();
                    let digits = number.split('e').next().unwrap();
                    let digits = digits.chars().filter(char::is_ascii_digit).count();
                    // Minutes and hours are no decimal part of a second.
                    let is_decimal = factors
                        .iter()
                        .all(|(symbol, _)| !["min", "h"].contains(symbol));
                    let spelling = format!("{value} {factors:?} is told as {told}");
                    assert!(!is_decimal || digits <= 10, "{spelling}");
                    assert!(!number.contains("0000000"), "{spelling}");
                    assert!(!number.contains("9999999"), "{spelling}");
                }
            }
        }
        assert_eq!(write(1000.0000000000001, &DENSITY), "1000 kg/m^3");
        assert_eq!(write(0.1 + 0.2, &NUMBER), "0.3");
    }
}
