//! The numbers of a scene by their names, to read and to change one by one.
//!
//! A new term of the model is a line in `SCALARS` for each of its numbers; the tests fail for a
//! number of a scene that has none, and for one that goes by another name or rule than in the
//! language.
mod change;

pub use change::{Change, ScalarError, changed};

use super::units::Dimension;
use super::{
    Agitation, Arrangement, Bond, ContactLaw, Enclosure, Flow, Scene, Strength, Turbulence,
};
use crate::suggest::nearest;

/// A number that a scene may have.
#[derive(Debug)]
pub struct Scalar {
    /// Its names, the full one first: the words in front of it in the language, joined by dots.
    names: &'static [&'static str],
    dimension: Dimension,
    rule: Rule,
    /// Where it is, in a scene that has it.
    at: fn(&mut Scene) -> Option<Place<'_>>,
}

/// Which values it may have, in SI units; the same as where a scene is read.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
    /// More than 0.
    Positive,
    /// At least this.
    AtLeast(f64),
    /// From the first to the second.
    Between(f64, f64),
    /// A whole number from the first to the second.
    Whole(u32, u32),
}

/// Where a number is kept.
enum Place<'a> {
    Real(&'a mut f64),
    Byte(&'a mut u8),
    Count(&'a mut u32),
    /// One that may be left out in a clause that is there.
    Optional(&'a mut Option<f64>),
    /// The upper end of a range; the lower end stays the same share of it.
    Range(&'a mut (f64, f64)),
    /// The lower end, at most the upper one.
    Low(&'a mut (f64, f64)),
}

use Dimension as D;
use Place::{Byte, Count, Low, Optional, Range, Real};
use Rule::{AtLeast, Between, Positive, Whole};

/// Every number of a scene, in the order of the language reference.
///
/// Of several that share a name, it stands for the one that the scene has.
static SCALARS: &[Scalar] = &[
    scalar(&["tick"], D::TIME, Positive, |s| Some(Real(&mut s.tick))),
    scalar(&["block.side"], D::LENGTH, Positive, |s| {
        Some(Real(&mut s.block.side))
    }),
    scalar(&["block.mass"], D::MASS, Positive, |s| {
        Some(Real(&mut s.block.mass))
    }),
    scalar(&["block.faces"], D::NUMBER, Whole(1, 5), |s| {
        Some(Byte(&mut s.block.faces))
    }),
    scalar(&["free"], D::NUMBER, Whole(0, 10_000_000), |s| {
        Some(Count(&mut s.free.count))
    }),
    scalar(&["free.ring"], D::LENGTH, Positive, |s| {
        let Arrangement::Ring { radius } = &mut s.free.arrangement else {
            return None;
        };
        Some(Real(radius))
    }),
    scalar(&["enclosure.radius"], D::LENGTH, Positive, |s| {
        let (Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. }) =
            s.enclosure.as_mut()?;
        Some(Real(radius))
    }),
    scalar(&["enclosure.wall"], D::STIFFNESS, Positive, |s| {
        let (Enclosure::Hemisphere { wall, .. } | Enclosure::Sphere { wall, .. }) =
            s.enclosure.as_mut()?;
        Some(Real(wall))
    }),
    scalar(&["gravity"], D::ACCELERATION, Positive, |s| {
        Some(Real(s.gravity.as_mut()?))
    }),
    scalar(&["fluid.density"], D::DENSITY, Positive, |s| {
        Some(Real(s.fluid.as_mut()?.density.as_mut()?))
    }),
    scalar(&["fluid.viscosity"], D::VISCOSITY, Positive, |s| {
        Some(Real(s.fluid.as_mut()?.viscosity.as_mut()?))
    }),
    scalar(&["flow.rate", "flow"], D::RATE, AtLeast(0.0), |s| {
        let Flow::Stir(stir) = s.flow.as_mut()? else {
            return None;
        };
        Some(Real(&mut stir.rate))
    }),
    scalar(&["flow.radius"], D::LENGTH, Positive, |s| {
        let Flow::Stir(stir) = s.flow.as_mut()? else {
            return None;
        };
        Some(Real(&mut stir.radius))
    }),
    scalar(&["flow.force"], D::FORCE, Positive, |s| {
        let Flow::Stir(stir) = s.flow.as_mut()? else {
            return None;
        };
        Some(Real(stir.force.as_mut()?))
    }),
    scalar(&["flow.follow"], D::NUMBER, Between(0.0, 1.0), |s| {
        let Flow::Stir(stir) = s.flow.as_mut()? else {
            return None;
        };
        Some(Real(&mut stir.follow))
    }),
    scalar(&["flow.flow", "flow"], D::FLOW, Positive, |s| {
        let Flow::Jets(jets) = s.flow.as_mut()? else {
            return None;
        };
        Some(Real(&mut jets.flow))
    }),
    scalar(&["flow.count"], D::NUMBER, Whole(1, 64), |s| {
        let Flow::Jets(jets) = s.flow.as_mut()? else {
            return None;
        };
        Some(Byte(&mut jets.count))
    }),
    scalar(&["flow.nozzle"], D::LENGTH, Positive, |s| {
        let Flow::Jets(jets) = s.flow.as_mut()? else {
            return None;
        };
        Some(Real(&mut jets.nozzle))
    }),
    scalar(
        &["agitation.speed", "agitation"],
        D::SPEED,
        AtLeast(0.0),
        |s| {
            let Agitation::Kicks { speed } = s.agitation.as_mut()? else {
                return None;
            };
            Some(Range(speed))
        },
    ),
    scalar(&["agitation.speed.low"], D::SPEED, AtLeast(0.0), |s| {
        let Agitation::Kicks { speed } = s.agitation.as_mut()? else {
            return None;
        };
        Some(Low(speed))
    }),
    scalar(
        &["agitation.speed", "agitation"],
        D::SPEED,
        Positive,
        |s| match &mut turbulence(s)?.strength {
            Strength::Speed(speed) => Some(Real(speed)),
            Strength::Intensity(_) => None,
        },
    ),
    scalar(
        &["agitation.intensity", "agitation"],
        D::NUMBER,
        AtLeast(0.0),
        |s| match &mut turbulence(s)?.strength {
            Strength::Intensity(part) => Some(Real(part)),
            Strength::Speed(_) => None,
        },
    ),
    scalar(&["agitation.length"], D::LENGTH, Positive, |s| {
        Some(Real(&mut turbulence(s)?.length))
    }),
    scalar(&["agitation.time"], D::TIME, Positive, |s| {
        Some(Optional(&mut turbulence(s)?.time))
    }),
    scalar(
        &["agitation.vertical"],
        D::NUMBER,
        Between(0.01, 100.0),
        |s| Some(Real(&mut turbulence(s)?.vertical)),
    ),
    scalar(
        &["agitation.temperature", "agitation"],
        D::TEMPERATURE,
        Positive,
        |s| {
            let Agitation::Brownian { temperature } = s.agitation.as_mut()? else {
                return None;
            };
            Some(Real(temperature))
        },
    ),
    scalar(&["drag.rate", "drag"], D::RATE, Positive, |s| {
        Some(Real(&mut s.drag.as_mut()?.rate))
    }),
    scalar(
        &["contact.restitution"],
        D::NUMBER,
        Between(0.0, 1.0),
        |s| match &mut s.contact.as_mut()?.law {
            ContactLaw::Rigid { restitution } => Some(Real(restitution)),
            ContactLaw::Compliant { .. } => None,
        },
    ),
    scalar(
        &["contact.stiffness"],
        D::STIFFNESS,
        Positive,
        |s| match &mut s.contact.as_mut()?.law {
            ContactLaw::Compliant { stiffness, .. } => Some(Real(stiffness)),
            ContactLaw::Rigid { .. } => None,
        },
    ),
    scalar(
        &["contact.damping"],
        D::DAMPING,
        AtLeast(0.0),
        |s| match &mut s.contact.as_mut()?.law {
            ContactLaw::Compliant { damping, .. } => Some(Real(damping)),
            ContactLaw::Rigid { .. } => None,
        },
    ),
    scalar(&["contact.friction"], D::NUMBER, AtLeast(0.0), |s| {
        Some(Real(&mut s.contact.as_mut()?.friction))
    }),
    scalar(&["bond.pull"], D::FORCE, AtLeast(0.0), |s| {
        let Bond::Attract { pull, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut pull.force))
    }),
    scalar(&["bond.pull.within"], D::LENGTH, Positive, |s| {
        let Bond::Attract { pull, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut pull.within))
    }),
    scalar(&["bond.align"], D::FORCE, AtLeast(0.0), |s| {
        let Bond::Attract { align, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut align.as_mut()?.force))
    }),
    scalar(&["bond.align.within"], D::LENGTH, Positive, |s| {
        let Bond::Attract { align, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut align.as_mut()?.within))
    }),
    scalar(&["bond.hold"], D::FORCE, Positive, |s| {
        let Bond::Reject { magnets, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut magnets.hold))
    }),
    scalar(&["bond.depth"], D::LENGTH, Positive, |s| {
        let Bond::Reject { magnets, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut magnets.depth))
    }),
    scalar(&["bond.within"], D::LENGTH, Positive, |s| {
        let Bond::Reject { magnets, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut magnets.within))
    }),
    scalar(&["bond.impulse"], D::IMPULSE, AtLeast(0.0), |s| {
        let Bond::Reject { impulse, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(impulse))
    }),
    scalar(&["bond.head"], D::PRESSURE, Positive, |s| {
        let Bond::Suction { pump, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut pump.head))
    }),
    scalar(&["bond.supply"], D::RESISTANCE, AtLeast(0.0), |s| {
        let Bond::Suction { pump, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut pump.supply))
    }),
    scalar(&["bond.valve"], D::RESISTANCE, Positive, |s| {
        let Bond::Suction { pump, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut pump.valve))
    }),
    scalar(&["bond.passage"], D::RESISTANCE, AtLeast(0.0), |s| {
        let Bond::Suction { pump, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(&mut pump.passage))
    }),
    scalar(&["bond.seal"], D::LENGTH, Positive, |s| {
        let Bond::Suction { seal, .. } = s.bond.as_mut()? else {
            return None;
        };
        Some(Real(seal))
    }),
    scalar(&["bond.anchor"], D::LENGTH, Positive, |s| {
        Some(Real(&mut s.bond.as_mut()?.anchor_mut().within))
    }),
    scalar(
        &["bond.anchor.tilt"],
        D::NUMBER,
        Between(1e-6, std::f64::consts::FRAC_PI_2),
        |s| Some(Real(&mut s.bond.as_mut()?.anchor_mut().tilt)),
    ),
    scalar(
        &["messages.hop", "messages"],
        D::TICKS,
        Whole(0, 1_000_000),
        |s| Some(Count(&mut s.messages.as_mut()?.hop)),
    ),
    scalar(&["messages.loss"], D::NUMBER, Between(0.0, 1.0), |s| {
        Some(Optional(&mut s.messages.as_mut()?.loss))
    }),
];

fn turbulence(scene: &mut Scene) -> Option<&mut Turbulence> {
    match scene.agitation.as_mut()? {
        Agitation::Turbulence(turbulence) => Some(turbulence),
        Agitation::Kicks { .. } | Agitation::Brownian { .. } => None,
    }
}

const fn scalar(
    names: &'static [&'static str],
    dimension: Dimension,
    rule: Rule,
    at: fn(&mut Scene) -> Option<Place<'_>>,
) -> Scalar {
    Scalar {
        names,
        dimension,
        rule,
        at,
    }
}

/// Every number of any scene, in the order of the language reference.
pub fn all() -> &'static [Scalar] {
    SCALARS
}

/// Every number that a scene has a place for, in the order of the language reference.
pub fn scalars(scene: &Scene) -> impl Iterator<Item = &'static Scalar> {
    let mut scene = scene.clone();
    let all = SCALARS.iter();
    all.filter(move |scalar| (scalar.at)(&mut scene).is_some())
}

/// The number of a scene that a name stands for: its full name or a short one.
///
/// # Errors
/// When no scene has one of that name, or this one has not.
pub fn find(scene: &Scene, name: &str) -> Result<&'static Scalar, ScalarError> {
    if let Some(found) = scalars(scene).find(|scalar| scalar.names.contains(&name)) {
        return Ok(found);
    }
    let has = || scalars(scene).map(Scalar::name).collect::<Vec<_>>();
    let elsewhere = SCALARS.iter().find(|scalar| scalar.names.contains(&name));
    if let Some(scalar) = elsewhere {
        let clause = scalar.clause();
        return Err(ScalarError::Absent {
            name: scalar.name(),
            scene: scene.name.clone(),
            clause: (!scalars(scene).any(|other| other.clause() == clause)).then_some(clause),
            has: has(),
        });
    }
    let mut known: Vec<&str> = has();
    known.extend(SCALARS.iter().flat_map(|scalar| scalar.names));
    // What is said of a clause may be found by its last word too: `friction`.
    let last = |scalar: &&Scalar| scalar.name().rsplit('.').next() == Some(name);
    let mut ends = scalars(scene).filter(last);
    let meant = match (ends.next(), ends.next()) {
        (Some(only), None) => Some(only.name().to_owned()),
        _ => nearest(name, known).map(|meant| meant.word),
    };
    Err(ScalarError::Unknown {
        name: name.to_owned(),
        scene: scene.name.clone(),
        meant,
        has: has(),
    })
}

impl Scalar {
    /// Its full name, such as `bond.pull`.
    pub fn name(&self) -> &'static str {
        self.names[0]
    }

    /// The clause that it belongs to.
    fn clause(&self) -> &'static str {
        let name = self.name();
        name.split_once('.').map_or(name, |(clause, _)| clause)
    }

    /// Whether only whole numbers will do.
    pub fn is_whole(&self) -> bool {
        matches!(self.rule, Rule::Whole(..))
    }

    /// What it is, with an example: ``a force, such as `15 N` ``.
    pub fn noun(&self) -> &'static str {
        self.dimension.noun()
    }

    /// Its value in a scene, in SI units; `None`: the scene does not say it.
    pub fn get(&self, scene: &Scene) -> Option<f64> {
        let mut scene = scene.clone();
        match (self.at)(&mut scene)? {
            Real(value) => Some(*value),
            Byte(value) => Some((*value).into()),
            Count(value) => Some((*value).into()),
            Optional(value) => *value,
            Range((_, high)) => Some(*high),
            Low((low, _)) => Some(*low),
        }
    }

    /// A value in SI units, if it is one that this number may have.
    ///
    /// # Errors
    /// When it is of another dimension, or out of its range.
    pub fn accept(&self, (value, found): (f64, Dimension)) -> Result<f64, ScalarError> {
        if found != self.dimension {
            return Err(ScalarError::Dimension {
                name: self.name(),
                expected: self.noun(),
                found: found.noun(),
            });
        }
        self.check(value)?;
        Ok(value)
    }

    /// Whether a value in SI units is one that it may have.
    pub(super) fn check(&self, value: f64) -> Result<(), ScalarError> {
        let (is_within, rule) = match self.rule {
            Positive => (
                (f64::MIN_POSITIVE..=f64::MAX).contains(&value),
                "more than 0".to_owned(),
            ),
            AtLeast(least) => (
                (least..=f64::MAX).contains(&value),
                format!("at least {least}"),
            ),
            Between(least, std::f64::consts::FRAC_PI_2) => (
                (least..=std::f64::consts::FRAC_PI_2).contains(&value),
                "more than 0 and at most 90 deg".to_owned(),
            ),
            Between(least, most) => (
                (least..=most).contains(&value),
                format!("from {least} to {most}"),
            ),
            Whole(least, most) => (
                value.fract() == 0.0 && (least.into()..=most.into()).contains(&value),
                format!("a whole number from {least} to {most}"),
            ),
        };
        match is_within {
            true => Ok(()),
            false => Err(ScalarError::Range {
                name: self.name(),
                value,
                rule,
            }),
        }
    }

    /// Gives it another value in a scene, in SI units.
    ///
    /// # Errors
    /// When it is out of its range.
    pub fn set(&self, scene: &mut Scene, value: f64) -> Result<(), ScalarError> {
        self.check(value)?;
        match (self.at)(scene) {
            // Whole and within the range of its type, or `check` would have refused it.
            Some(Byte(place)) => *place = value as u8,
            Some(Count(place)) => *place = value as u32,
            Some(Real(place)) => *place = value,
            Some(Optional(place)) => *place = Some(value),
            Some(Range(place)) => {
                let share = if place.0 < place.1 {
                    place.0 / place.1
                } else {
                    1.0
                };
                *place = (share * value, value);
            }
            Some(Low(place)) if value <= place.1 => place.0 = value,
            Some(Low(place)) => {
                return Err(ScalarError::Range {
                    name: self.name(),
                    value,
                    rule: format!("at most the upper end, {}", place.1),
                });
            }
            None => {}
        }
        Ok(())
    }
}
