//! One number of a scene: what it is, which values it may have, and where it is kept.
use super::super::Scene;
use super::super::quantity::QuantityKind;
use super::super::scalar_error::ScalarError;
use super::super::units::Dimension;

/// A number that a scene may have.
#[derive(Debug)]
pub struct SchemaNumber {
    /// Its names, the full one first: the words in front of it in the language, joined by dots.
    pub names: &'static [&'static str],
    /// What it is one of.
    pub kind: QuantityKind,
    /// Which values it may have.
    pub range: Range,
    /// What equations call it; empty: it is in none.
    pub symbol: &'static str,
    /// What it is called beside its value.
    pub label: &'static str,
    /// What it means, as a clause.
    pub meaning: &'static str,
    /// Where it is, in a scene that has a place for it.
    pub(super) at: fn(&mut Scene) -> Option<Accessor<'_>>,
}

/// Which values a number may have, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// More than 0.
    Positive,
    /// At least this.
    AtLeast(f64),
    /// From the first to the second.
    Between(f64, f64),
    /// An angle of more than 0 and at most a quarter of a turn.
    Acute,
    /// A whole number from the first to the second.
    Whole(u32, u32),
}

/// Where a number is kept.
pub(super) enum Accessor<'a> {
    Real(&'a mut f64),
    Byte(&'a mut u8),
    Count(&'a mut u32),
    /// One that may be left out in a clause that is there.
    Optional(&'a mut Option<f64>),
    /// The same, but no number to change where it is left out: it would be another term.
    Term(&'a mut Option<f64>),
    /// The upper end of a range; the lower end stays the same share of it.
    High(&'a mut (f64, f64)),
    /// The lower end, at most the upper one.
    Low(&'a mut (f64, f64)),
}

impl<'a> From<&'a mut f64> for Accessor<'a> {
    fn from(place: &'a mut f64) -> Accessor<'a> {
        Accessor::Real(place)
    }
}

impl<'a> From<&'a mut u8> for Accessor<'a> {
    fn from(place: &'a mut u8) -> Accessor<'a> {
        Accessor::Byte(place)
    }
}

impl<'a> From<&'a mut u32> for Accessor<'a> {
    fn from(place: &'a mut u32) -> Accessor<'a> {
        Accessor::Count(place)
    }
}

impl Range {
    /// What is computed with, in SI units, beside 0: products of a few of these are numbers still.
    const COMPUTABLE: std::ops::RangeInclusive<f64> = 1e-50..=1e50;

    /// What a value that somebody gives in SI units has to be and is not; `None`: it is in the range.
    pub fn violated(self, value: f64) -> Option<String> {
        let is_open = matches!(self, Range::Positive | Range::AtLeast(_));
        if is_open && value > 0.0 && !Range::COMPUTABLE.contains(&value) {
            let (least, most) = (Range::COMPUTABLE.start(), Range::COMPUTABLE.end());
            return Some(format!("from {least:e} to {most:e} in SI units"));
        }
        (!self.contains(value)).then(|| self.rule())
    }

    /// Whether a value in SI units is in it, computed with or not.
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

    /// What a value has to be, such as `more than 0`.
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
    /// Its full name, such as `bond.pull`.
    pub fn name(&self) -> &'static str {
        self.names[0]
    }

    /// The clause that it belongs to.
    pub fn clause(&self) -> &'static str {
        let name = self.name();
        name.split_once('.').map_or(name, |(clause, _)| clause)
    }

    /// Whether only whole numbers will do.
    pub fn is_whole(&self) -> bool {
        matches!(self.range, Range::Whole(..))
    }

    /// Whether a scene has a place for it.
    pub fn is_in(&self, scene: &Scene) -> bool {
        let place = |place| !matches!(place, Accessor::Term(None));
        (self.at)(&mut scene.clone()).is_some_and(place)
    }

    /// Its value in a scene, in SI units; `None`: the scene does not say it.
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

    /// A value in SI units, if it is one that this number may have.
    ///
    /// # Errors
    /// When it is of another dimension, or out of its range.
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

    /// What has been computed before may be out of what is computed with now.
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

    /// Gives it another value in a scene, in SI units.
    ///
    /// # Errors
    /// When it is out of its range.
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

    /// Puts a value that is in its range where it belongs, in a scene that has a place for it.
    pub fn put(&self, scene: &mut Scene, value: f64) {
        match (self.at)(scene) {
            // Whole and within the range of its type.
            Some(Accessor::Byte(place)) => *place = value as u8,
            Some(Accessor::Count(place)) => *place = value as u32,
            Some(Accessor::Real(place)) => *place = value,
            Some(Accessor::Optional(place) | Accessor::Term(place)) => *place = Some(value),
            Some(Accessor::High(place)) => {
                let share = if place.0 < place.1 {
                    place.0 / place.1
                } else {
                    1.0
                };
                *place = (share * value, value);
            }
            Some(Accessor::Low(place)) => place.0 = value,
            None => {}
        }
    }
}
