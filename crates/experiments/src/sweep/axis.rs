//! Axes of a sweep, parsed from texts such as `free=50..600/6 log`.
use stochc_ir::scene::scalars::ScalarError;
use stochc_ir::scene::schema::SchemaNumber;
use stochc_ir::scene::units::WrittenQuantity;

use stochc_results::{ChosenSetting, Varied};

use super::parameter::Parameter;

use super::error::{MAX_VALUES, RangeError};

/// Axis of a sweep: a parameter of a program or scene, or a setting, with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name of the parameter or setting, as the user wrote it.
    pub name: String,
    values: AxisValues,
    /// Unit of all values. Empty for values without a unit.
    unit: String,
}

#[derive(Clone, Debug, PartialEq)]
enum AxisValues {
    /// Listed values: `50,100,300`, or a single value.
    List(Vec<f64>),
    /// Evenly spaced values, including both ends: `50..600/6`.
    Even { from: f64, to: f64, n: u32 },
    /// Values with a constant ratio between neighbours: `50..600/6 log`.
    Geometric { from: f64, to: f64, n: u32 },
    /// Values of a setting: `model=rigid,rapier`.
    Settings(Vec<ChosenSetting>),
}

impl Axis {
    /// Parses an axis of the form `NAME=VALUES`.
    ///
    /// # Errors
    ///
    /// If the form is wrong. Does not check whether a scene has the parameter.
    pub fn parse(text: &str) -> Result<Axis, RangeError> {
        let (name, values) = text
            .split_once('=')
            .filter(|(name, _)| !name.trim().is_empty())
            .ok_or(RangeError::Axis)?;
        let name = name.trim();
        if ChosenSetting::is_name(name) {
            let chosen = settings(name, values)?;
            return Ok(Axis {
                name: name.to_owned(),
                values: AxisValues::Settings(chosen),
                unit: String::new(),
            });
        }
        let (spaced, is_geometric) = logarithmic(values);
        let (values, unit) = match spaced.split_once("..") {
            Some((from, rest)) => range(from, rest, is_geometric)?,
            None if is_geometric => return Err(RangeError::ListWithLog),
            None => list(spaced)?,
        };
        Ok(Axis {
            name: name.to_owned(),
            values,
            unit,
        })
    }

    /// Returns the values of the setting that the axis varies. Returns `None` if the axis varies a
    /// parameter of a program or scene.
    pub fn settings(&self) -> Option<&[ChosenSetting]> {
        match &self.values {
            AxisValues::Settings(chosen) => Some(chosen),
            AxisValues::List(_) | AxisValues::Even { .. } | AxisValues::Geometric { .. } => None,
        }
    }

    /// Returns the values of the axis for a parameter, each with its unit.
    ///
    /// # Errors
    ///
    /// If a value is out of range, is not an integer for an integer parameter, or occurs twice.
    pub fn values(&self, parameter: Parameter<'_>) -> Result<Vec<Varied>, RangeError> {
        let mut out: Vec<Varied> = Vec::new();
        for given in self.given_values(parameter)? {
            let varied = parameter.with_value(given, &self.unit)?;
            if out.iter().any(|other| other.value == varied.value) {
                return Err(RangeError::ValueTwice {
                    name: varied.name.clone(),
                    value: varied.value(),
                });
            }
            out.push(varied);
        }
        Ok(out)
    }

    fn given_values(&self, parameter: Parameter<'_>) -> Result<Vec<f64>, RangeError> {
        Ok(match self.values {
            AxisValues::Settings(_) => return Err(RangeError::Setting(self.name.clone())),
            AxisValues::List(ref values) => values.clone(),
            AxisValues::Even { from, to, n } => {
                let values: Vec<f64> = (0..n).map(|i| even(from, to, n, i)).collect();
                let broken = values.iter().find(|value| value.fract() != 0.0);
                if let (true, Some(broken)) = (parameter.is_whole(), broken) {
                    return Err(not_whole(parameter.name(), from, to, n, *broken));
                }
                values
            }
            AxisValues::Geometric { from, to, n } => {
                let round = |value: f64| {
                    if parameter.is_whole() {
                        value.round()
                    } else {
                        digits(value, 4)
                    }
                };
                let inner = (1..n - 1).map(|i| {
                    let share = f64::from(i) / f64::from(n - 1);
                    round(from * (to / from).powf(share))
                });
                std::iter::once(from).chain(inner).chain([to]).collect()
            }
        })
    }
}

/// Parses the values of a setting. No value may occur twice.
fn settings(name: &str, values: &str) -> Result<Vec<ChosenSetting>, RangeError> {
    let mut chosen: Vec<ChosenSetting> = Vec::new();
    for value in values.split(',') {
        let value = ChosenSetting::new(name, value.trim())?;
        if chosen.contains(&value) {
            return Err(RangeError::SettingTwice(value.text()));
        }
        chosen.push(value);
    }
    Ok(chosen)
}

/// Removes the word `log` from the end of the values. Returns the remaining text, and whether the
/// word was present.
pub(crate) fn logarithmic(values: &str) -> (&str, bool) {
    let values = values.trim();
    match values.strip_suffix("log") {
        Some(before) if before.ends_with(char::is_whitespace) => (before.trim_end(), true),
        _ => (values, false),
    }
}

/// Returns a scene parameter with the value `given` in `unit`.
///
/// # Errors
///
/// If the parameter cannot have this value.
pub(crate) fn varied(number: &SchemaNumber, given: f64, unit: &str) -> Result<Varied, RangeError> {
    let text = format!("{given} {unit}");
    let mut quantity = WrittenQuantity::parse(&text)?.to_si();
    // Zero is the same in all units.
    if given == 0.0 && unit.is_empty() {
        quantity.1 = number.kind.dimension;
    }
    let value = number.accept(quantity).map_err(|error| match &error {
        ScalarError::Dimension { .. } if unit.is_empty() => RangeError::NoUnit {
            unit: number.kind.example_unit(),
            error,
        },
        _ => RangeError::SceneValue(error),
    })?;
    Ok(Varied {
        name: number.name().to_owned(),
        value,
        given,
        unit: unit.to_owned(),
    })
}

fn even(from: f64, to: f64, n: u32, i: u32) -> f64 {
    match i {
        0 => from,
        i if i == n - 1 => to,
        i => digits(from + (to - from) * (f64::from(i) / f64::from(n - 1)), 12),
    }
}

/// Rounds a value to `n` significant digits. This removes rounding errors such as
/// `0.30000000000000004`.
pub(crate) fn digits(value: f64, n: usize) -> f64 {
    let rounded = format!("{value:.*e}", n - 1).parse();
    rounded.unwrap_or(value)
}

/// Returns the error for an integer parameter whose evenly spaced values are not all integers. The
/// error suggests another number of values.
fn not_whole(name: &str, from: f64, to: f64, n: u32, broken: f64) -> RangeError {
    let whole = |n: &u32| (1..n - 1).all(|i| even(from, to, *n, i).fract() == 0.0);
    let ends = from.fract() == 0.0 && to.fract() == 0.0;
    let mut fitting: Vec<u32> = (2..=60).filter(|n| ends && whole(n)).collect();
    fitting.sort_by_key(|other| other.abs_diff(n));
    fitting.truncate(4);
    fitting.sort_unstable();
    let help = match fitting[..] {
        [] => "give whole numbers as ends".to_owned(),
        _ => {
            let fitting: Vec<String> = fitting.iter().map(u32::to_string).collect();
            format!("{} values are all whole", fitting.join(", "))
        }
    };
    RangeError::NotWhole {
        name: name.to_owned(),
        n,
        from,
        to,
        broken: digits(broken, 6),
        help,
    }
}

/// Parses a range such as `50..600/6`. The arguments are the parts before and after the dots.
fn range(from: &str, rest: &str, is_geometric: bool) -> Result<(AxisValues, String), RangeError> {
    let count = rest.rsplit_once('/').and_then(|(to, n)| {
        let n = n.trim();
        let is_number = !n.is_empty() && n.chars().all(|c| c.is_ascii_digit());
        is_number.then_some((to, n))
    });
    let Some((to, n)) = count else {
        return Err(RangeError::NoCount {
            from: from.trim().to_owned(),
            to: rest.trim().to_owned(),
        });
    };
    let n = (n.parse().ok())
        .filter(|n| (2..=MAX_VALUES).contains(n))
        .ok_or_else(|| RangeError::Count(n.to_owned()))?;
    let (first, last) = (value(from)?, value(to)?);
    let unit = common(&[first.clone(), last.clone()])?;
    let (from, to) = (first.0, last.0);
    if !is_geometric {
        return Ok((AxisValues::Even { from, to, n }, unit));
    }
    if from > 0.0 && to > 0.0 {
        Ok((AxisValues::Geometric { from, to, n }, unit))
    } else {
        Err(RangeError::AxisWithLog)
    }
}

fn list(text: &str) -> Result<(AxisValues, String), RangeError> {
    let values: Vec<_> = text.split(',').map(value).collect::<Result<_, _>>()?;
    let unit = common(&values)?;
    let values = values.into_iter().map(|(number, _)| number);
    Ok((AxisValues::List(values.collect()), unit))
}

/// Parses a number and its unit.
pub(crate) fn value(text: &str) -> Result<(f64, String), RangeError> {
    let WrittenQuantity { value, unit, .. } =
        WrittenQuantity::parse(text).map_err(|error| dash(text).unwrap_or(error.into()))?;
    Ok((value, unit.to_owned()))
}

/// Returns the error of a range with a dash, such as `10-20`.
fn dash(text: &str) -> Option<RangeError> {
    let (from, to) = text.trim().split_once('-')?;
    let is_value = |text: &str| WrittenQuantity::parse(text).is_ok();
    let [from, to] = [from, to].map(|it| it.trim().to_owned());
    (is_value(&from) && is_value(&to)).then_some(RangeError::Dash(from, to))
}

/// Returns the common unit of these values. The unit of the last value also applies to values
/// without a unit.
pub(crate) fn common(values: &[(f64, String)]) -> Result<String, RangeError> {
    let unit = values.last().map_or("", |(_, unit)| unit);
    let other = values.iter().find(|(_, it)| !it.is_empty() && it != unit);
    match other {
        Some((_, other)) => Err(RangeError::Units {
            other: other.clone(),
            last: unit.to_owned(),
        }),
        None => Ok(unit.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use stochc_compiler::scene::built_in;
    use stochc_ir::scene::scalars::find;

    use super::*;

    /// Returns the values of an axis in the default scene, first in its unit, then in SI units.
    fn values(text: &str) -> Result<(Vec<f64>, Vec<f64>), RangeError> {
        let axis = Axis::parse(text)?;
        let scene = built_in("hemisphere").unwrap();
        let scalar = find(&scene, &axis.name)?;
        let values = axis.values(Parameter::Scene(scalar))?;
        let given = values.iter().map(|varied| varied.given).collect();
        Ok((given, values.iter().map(|varied| varied.value).collect()))
    }

    fn error(text: &str) -> String {
        values(text).unwrap_err().to_string()
    }

    #[test]
    fn values_are_spaced_evenly_by_ratio_or_listed() {
        let given = |text: &str| values(text).unwrap().0;
        assert_eq!(given("free=50..550/6"), [50., 150., 250., 350., 450., 550.]);
        assert_eq!(
            given("bond.pull = 2 .. 12 N / 5"),
            [2.0, 4.5, 7.0, 9.5, 12.0]
        );
        assert_eq!(given("bond.pull=0.1..0.4 N/4"), [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(given("contact.friction=1..0/3"), [1.0, 0.5, 0.0]);
        assert_eq!(given("enclosure.wall=1..100 N/m/3 log"), [1.0, 10.0, 100.0]);
        assert_eq!(given("enclosure.wall=1..3 N/m/3 log"), [1.0, 1.732, 3.0]);
        assert_eq!(given("free=50..600/4 log"), [50.0, 114.0, 262.0, 600.0]);
        assert_eq!(given("free=50,100,300"), [50.0, 100.0, 300.0]);
        assert_eq!(given("tick=10 ms"), [10.0]);
    }

    #[test]
    fn units_are_stored_and_values_are_in_si() {
        let (given, si) = values("block.side=10,20,25 cm").unwrap();
        assert_eq!((given, si), (vec![10., 20., 25.], vec![0.1, 0.2, 0.25]));
        assert_eq!(values("tick=10ms,20ms").unwrap().1, [0.01, 0.02]);
        assert_eq!(values("contact.damping=5 N s/m").unwrap().1, [5.0]);
    }

    #[test]
    fn whole_numbers_stay_whole() {
        assert_eq!(
            error("free=50..600/7"),
            "`free` is a whole number, and 7 values from 50 to 600 are not all: 141.667 is one; \
             2, 3, 6, 11 values are all whole, `log` rounds, or give a list"
        );
        assert!(error("free=50.5..600/2").contains("give whole numbers as ends"));
        assert!(error("free=50,60.5").contains("must be a whole number from 0"));
        assert!(error("free=1..4/9 log").contains("twice"));
    }

    #[test]
    fn settings_are_listed() {
        let axis = Axis::parse("substeps = 1, 2/8").unwrap();
        let values: Vec<&str> = axis
            .settings()
            .unwrap()
            .iter()
            .map(|it| it.value())
            .collect();
        assert_eq!(values, ["1", "2/8"]);
        assert_eq!(Axis::parse("free=5").unwrap().settings(), None);
        for (text, reason) in [
            ("model=rigid,rapid", "`model=rapid`: give one of `rigid`"),
            ("substeps=1,2,1", "`substeps=1` is given twice"),
            ("precision=", "give one of"),
        ] {
            let message = Axis::parse(text).unwrap_err().to_string();
            assert!(message.contains(reason), "{text}: {message}");
        }
    }

    #[test]
    fn errors_propose_a_correction() {
        for (text, reason) in [
            ("free", "write NAME=VALUES"),
            ("=5", "write NAME=VALUES"),
            ("free=", "is no value"),
            (
                "free=10-20",
                "write `10..20/3` for three values, or `10,20` for two",
            ),
            ("free.cuont=10,20", "did you mean `free`?"),
            ("free=50..600", "how many values from `50` to `600`?"),
            ("bond.pull=2..12 N/m", "how many values"),
            ("free=50..600/1", "2 to 400 values"),
            ("free=50..600/100000000000000", "2 to 400 values"),
            ("free=..600/3", "is no value"),
            ("free=50,,60", "is no value"),
            ("free=0..600/3 log", "above 0"),
            ("free=50,60 log", "`log` spaces a range"),
            (
                "block.side=20cm..1m/3",
                "give all values one unit, not `cm` and `m`",
            ),
            ("bond.pull=3 newton", "did you mean `N`?"),
            (
                "bond.pull=3 m",
                "`bond.pull` is a force, such as `15 N`, not a length",
            ),
            ("free=50,50", "`free` has the value 50 twice"),
            ("free=50..50/3", "`free` has the value 50 twice"),
            ("fre=50", "did you mean `free`?"),
        ] {
            assert!(error(text).contains(reason), "{text}: {}", error(text));
        }
    }
}
