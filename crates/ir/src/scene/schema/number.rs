//! Scene parameter: its kind, range and location.
use super::super::Scene;
use super::super::quantity::QuantityKind;
use super::super::scalar_error::ScalarError;
use super::super::units::Dimension;

/// Parameter that a scene may have.
#[derive(Debug)]
pub struct SchemaNumber {
    /// Names of the parameter. The full name comes first: the preceding keywords, joined by dots.
    pub names: &'static [&'static str],
    /// Kind of quantity of the parameter.
    pub kind: QuantityKind,
    /// Range of valid values.
    pub range: Range,
    /// Symbol in equations. Empty if no equation contains the parameter.
    pub symbol: &'static str,
    /// Label for the value.
    pub label: &'static str,
    /// Meaning, as a clause.
    pub meaning: &'static str,
    /// Function that locates the value in a scene. Returns `None` if the scene does not have the
    /// parameter.
    pub(super) at: fn(&mut Scene) -> Option<Accessor<'_>>,
}

/// Range of a parameter, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Values above 0.
    Positive,
    /// Values of at least this number.
    AtLeast(f64),
    /// Values from the first number to the second.
    Between(f64, f64),
    /// Angle of more than 0 and at most 90 degrees.
    Acute,
    /// Integer from the first to the second.
    Whole(u32, u32),
}

/// Location of a parameter's value in a scene.
pub(super) enum Accessor<'a> {
    Real(&'a mut f64),
    Byte(&'a mut u8),
    Count(&'a mut u32),
    /// Optional parameter of a clause.
    Optional(&'a mut Option<f64>),
    /// Optional parameter that is a term of its own. It cannot be changed if it is absent.
    Term(&'a mut Option<f64>),
    /// Upper end of a range. If it changes, the lower end changes by the same factor.
    High(&'a mut (f64, f64)),
    /// Lower end of a range, at most the upper end.
    Low(&'a mut (f64, f64)),
}

impl<'a> From<&'a mut f64> for Accessor<'a> {
    fn from(target: &'a mut f64) -> Accessor<'a> {
        Accessor::Real(target)
    }
}

impl<'a> From<&'a mut u8> for Accessor<'a> {
    fn from(target: &'a mut u8) -> Accessor<'a> {
        Accessor::Byte(target)
    }
}

impl<'a> From<&'a mut u32> for Accessor<'a> {
    fn from(target: &'a mut u32) -> Accessor<'a> {
        Accessor::Count(target)
    }
}

impl Range {
    /// Allowed magnitudes of values other than 0. Products of a few such values neither overflow
    /// nor underflow.
    const COMPUTABLE: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

    /// Returns the rule that a value in SI units violates, or `None` if it is valid.
    pub fn violated(self, value: f64) -> Option<String> {
        let is_open = matches!(self, Range::Positive | Range::AtLeast(_));
        let is_limited = is_open || self.contains(value);
        if is_limited && value > 0.0 && !Range::COMPUTABLE.contains(&value) {
            let (least, most) = (Range::COMPUTABLE.start(), Range::COMPUTABLE.end());
            return Some(format!("from {least:e} to {most:e} in SI units"));
        }
        (!self.contains(value)).then(|| self.rule())
    }

    /// Returns whether a value in SI units is in the range, without the limits of magnitude.
    pub fn contains(self, value: f64) -> bool {
        match self {
            Range::Positive => (f64::MIN_POSITIVE..=f64::MAX).contains(&value),
            Range::AtLeast(least) => (least..=f64::MAX).contains(&value),
            Range::Between(least, most) => (least..=most).contains(&value),
            Range::Acute => (1e-6..=std::f64::consts::FRAC_PI_2).contains(&value),
            Range::Whole(least, most) => {
                value.fract() == 0.0 && (least.into()..=most.into()).contains(&value)
            }
        }
    }

    /// Returns the rule for values, such as `more than 0`.
    pub fn rule(self) -> String {
        match self {
            Range::Positive => "more than 0".to_owned(),
            Range::AtLeast(least) => format!("at least {least}"),
            Range::Between(least, most) => format!("from {least} to {most}"),
            Range::Acute => "more than 0 and at most 90 deg".to_owned(),
            Range::Whole(least, most) => format!("a whole number from {least} to {most}"),
        }
    }
}

impl SchemaNumber {
    /// Returns the full name of the parameter, such as `bond.pull`.
    pub fn name(&self) -> &'static str {
        self.names[0]
    }

    /// Returns the clause of the parameter.
    pub fn clause(&self) -> &'static str {
        let name = self.name();
        name.split_once('.').map_or(name, |(clause, _)| clause)
    }

    /// Returns whether the parameter must be an integer.
    pub fn is_whole(&self) -> bool {
        matches!(self.range, Range::Whole(..))
    }

    /// Returns whether a scene has the parameter.
    pub fn is_in(&self, scene: &Scene) -> bool {
        let is_present = |target| !matches!(target, Accessor::Term(None));
        (self.at)(&mut scene.clone()).is_some_and(is_present)
    }

    /// Returns the value of the parameter in a scene, in SI units. Returns `None` if the scene does
    /// not give it.
    pub fn get(&self, scene: &Scene) -> Option<f64> {
        match (self.at)(&mut scene.clone())? {
            Accessor::Real(value) => Some(*value),
            Accessor::Byte(value) => Some((*value).into()),
            Accessor::Count(value) => Some((*value).into()),
            Accessor::Optional(value) | Accessor::Term(value) => *value,
            Accessor::High((_, high)) => Some(*high),
            Accessor::Low((low, _)) => Some(*low),
        }
    }

    /// Returns a value in SI units if it is valid.
    ///
    /// # Errors
    ///
    /// If it has another dimension or is out of range.
    pub fn accept(&self, (value, found): (f64, Dimension)) -> Result<f64, ScalarError> {
        if found != self.kind.dimension {
            return Err(ScalarError::Dimension {
                name: self.name(),
                expected: self.kind.dimension.noun(),
                found: found.noun(),
            });
        }
        match self.range.violated(value) {
            None => Ok(value),
            Some(rule) => Err(self.out_of_range(value, rule)),
        }
    }

    /// Checks the range only: stored values may have any magnitude.
    pub(in crate::scene) fn check(&self, value: f64) -> Result<(), ScalarError> {
        if self.range.contains(value) {
            Ok(())
        } else {
            Err(self.out_of_range(value, self.range.rule()))
        }
    }

    fn out_of_range(&self, value: f64, rule: String) -> ScalarError {
        ScalarError::Range {
            name: self.name(),
            value: self.kind.write(value),
            rule,
        }
    }

    /// Sets the value of the parameter in a scene, in SI units.
    ///
    /// # Errors
    ///
    /// If it is out of range.
    pub fn set(&self, scene: &mut Scene, value: f64) -> Result<(), ScalarError> {
        self.check(value)?;
        match (self.at)(scene) {
            Some(Accessor::Low((_, high))) if value > *high => Err(self.out_of_range(
                value,
                format!("at most the upper end, {}", self.kind.write(*high)),
            )),
            _ => {
                self.put(scene, value);
                Ok(())
            }
        }
    }

    /// Stores a valid value in a scene that has the parameter.
    pub fn put(&self, scene: &mut Scene, value: f64) {
        match (self.at)(scene) {
            // An integer within the range of its type.
            Some(Accessor::Byte(target)) => *target = value as u8,
            Some(Accessor::Count(target)) => *target = value as u32,
            Some(Accessor::Real(target)) => *target = value,
            Some(Accessor::Optional(target) | Accessor::Term(target)) => *target = Some(value),
            Some(Accessor::High(target)) => {
                let share = if target.0 < target.1 {
                    target.0 / target.1
                } else {
                    1.0
                };
                *target = (share * value, value);
            }
            Some(Accessor::Low(target)) => target.0 = value,
            None => {}
        }
    }
}
