//! Errors in ranges and values of scene parameters and settings.
use stochc_ir::scene::scalars::ScalarError;
use stochc_ir::scene::units::InvalidQuantity;
use stochc_results::InvalidSetting;
use thiserror::Error;

/// Largest number of values of an axis.
pub(super) const MAX_VALUES: u32 = 400;

/// Largest number of programs of a sweep.
pub const MAX_POINTS: usize = 400;

/// Error of an axis or a prior.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RangeError {
    /// An axis does not have the form `NAME=VALUES`.
    #[error("write NAME=VALUES, such as `free=50..600/6` or `bond.pull=2,4,8 N`")]
    Axis,
    /// A parameter with one value does not have the form `NAME=VALUE`.
    #[error("write NAME=VALUE with one value, such as `height=8` or `'bond.pull=10 N'`")]
    Value,
    /// A prior does not have the form `NAME=FROM..TO`.
    #[error("write NAME=FROM..TO, such as `bond.pull=2..12 N` or `free=50..500 log`")]
    Prior,
    /// A range is written with a dash. Contains its ends.
    #[error("`{0}-{1}` is not a range; write `{0}..{1}/3` for three values, or `{0},{1}` for two")]
    Dash(String, String),
    /// The word `log` follows a list.
    #[error("`log` spaces a range: write `a..b/n log`")]
    ListWithLog,
    /// A range with `log` includes 0 or less.
    #[error("a range with `log` is of values above 0")]
    AxisWithLog,
    /// A prior with `log` includes 0 or less.
    #[error("a range with `log` requires values above 0")]
    PriorWithLog,
    /// The end of a prior is not above its start.
    #[error("`{from}..{to}` is not a range; write the lower end first")]
    Empty {
        /// Lower end of the range.
        from: f64,
        /// Upper end of the range.
        to: f64,
    },
    /// A range does not state the number of its values.
    #[error("how many values from `{from}` to `{to}`? write `a..b/n`, such as `50..600/6`")]
    NoCount {
        /// First value of the range.
        from: String,
        /// Last value of the range.
        to: String,
    },
    /// A range has too few or too many values. Contains the number.
    #[error("a range has 2 to {MAX_VALUES} values, not {0}")]
    Count(String),
    /// Values have different units.
    #[error(
        "give all values one unit, not `{other}` and `{last}`; the unit of the last value applies to all"
    )]
    Units {
        /// Unit of another value.
        other: String,
        /// Unit of the last value.
        last: String,
    },
    /// A setting has a value twice.
    #[error("`{0}` is given twice")]
    SettingTwice(String),
    /// A scene parameter has a value twice.
    #[error("`{name}` has the value {value} twice; give fewer values")]
    ValueTwice {
        /// Name of the parameter.
        name: String,
        /// The value with its unit.
        value: String,
    },
    /// Two axes have the same name.
    #[error("`{0}` is swept twice")]
    AxisTwice(String),
    /// A parameter is varied, and `--set` gives it a single value.
    #[error("`{0}` is swept, and `--set` gives it a single value; leave out one of the two")]
    AxisIsSet(String),
    /// A setting is given, but a parameter is required.
    #[error("`{0}` is a setting, not a parameter of a program or scene")]
    Setting(String),
    /// Evenly spaced values of an integer parameter are not integers.
    #[error(
        "`{name}` is a whole number, and {n} values from {from} to {to} are not all: {broken} is one; \
         {help}, `log` rounds, or give a list"
    )]
    NotWhole {
        /// Name of the parameter.
        name: String,
        /// Number of values in the range.
        n: u32,
        /// First value of the range.
        from: f64,
        /// Last value of the range.
        to: f64,
        /// A value that is not an integer.
        broken: f64,
        /// Suggestion for the user.
        help: String,
    },
    /// The range of an integer parameter is too short for a polynomial.
    #[error(
        "`{0}` is a whole number, and its range needs at least five values; `stochc sweep` tries a few"
    )]
    ShortRange(String),
    /// Neither the program nor its scene has the parameter, but the program has a similar one.
    #[error("`{program}` has no parameter `{name}`; did you mean `{suggestion}`?")]
    NoParameter {
        /// Name of the program.
        program: String,
        /// The unknown name.
        name: String,
        /// Parameter with a similar name.
        suggestion: String,
    },
    /// The value of a program's parameter is not an integer, or has a unit.
    #[error("`{name}` is a parameter of a program and requires a whole number, not {value}")]
    ProgramParameter {
        /// Name of the parameter.
        name: String,
        /// The value with its unit.
        value: String,
    },
    /// A sweep has too many points.
    #[error(
        "the sweep has {0} or more points, more than the limit of {MAX_POINTS}; give fewer values"
    )]
    Points(usize),
    /// The scene does not have this parameter.
    #[error("{error}{}", listed(error.has()))]
    Parameter {
        /// Reason why the parameter is unknown.
        error: ScalarError,
    },
    /// The scene parameter cannot have the value.
    #[error(transparent)]
    SceneValue(#[from] ScalarError),
    /// The values have no unit, and the parameter needs one.
    #[error("{error}; write the unit after the last value, such as `2,4,8 {unit}`")]
    NoUnit {
        /// Reason, with the kind of the parameter.
        error: ScalarError,
        /// A unit of the parameter.
        unit: &'static str,
    },
    /// The value is not a quantity.
    #[error(transparent)]
    Quantity(#[from] InvalidQuantity),
    /// The setting cannot have the value.
    #[error(transparent)]
    Choice(#[from] InvalidSetting),
}

/// Returns the names of a scene's parameters, in parentheses.
fn listed(has: &[&str]) -> String {
    match has {
        [] => String::new(),
        has => format!(" (it has {})", has.join(", ")),
    }
}
