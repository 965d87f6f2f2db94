//! The scene in block units: side 1, mass 1, and the tick as the unit of time.
//!
//! Single precision and contact settings then mean the same for a block of 10 um and of 20 cm.
use stochc_compiler::scene::{Agitation, Bond, ContactLaw, Enclosure, Measure, Reach, Scene};

use super::SceneError;
use crate::settings::Settings;

/// The terms that this build can compute: without one, its code is unreachable and left out.
pub(crate) mod built {
    pub const AGITATION: bool = cfg!(feature = "agitation");
    pub const BOND: bool = cfg!(feature = "bond");
    pub const CONTACT: bool = cfg!(feature = "contact");
    pub const DRAG: bool = cfg!(feature = "drag");
    pub const ENCLOSURE: bool = cfg!(feature = "enclosure");
}

/// The terms in force; `None` is a term that does not exist.
#[derive(Clone, Debug)]
pub(crate) struct Terms {
    pub hemisphere: Option<Hemisphere>,
    pub kicks: Option<Kicks>,
    /// Rate of the linear drag \[1 / tick\].
    pub drag: Option<f64>,
    pub contact: Option<Contact>,
    pub bond: Option<Magnet>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Hemisphere {
    /// \[side\]
    pub radius: f64,
    /// Acceleration per depth \[1 / tick^2\].
    pub stiffness: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Kicks {
    /// Least and most change of speed \[side / tick\].
    pub speed: (f64, f64),
}

#[derive(Clone, Debug)]
pub(crate) struct Contact {
    /// In block units: stiffness \[1 / tick^2\] and damping \[1 / tick\] for a mass of 1.
    pub law: ContactLaw,
    pub friction: f64,
}

/// How a magnetized face captures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Magnet {
    pub pull: Pull,
    pub align: Option<Pull>,
    pub measure: Measure,
    /// Anchoring distance \[side\].
    pub within: f64,
    /// Cosine of the greatest tilt at which a block is anchored.
    pub cos_tilt: f64,
}

/// A force of constant magnitude.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    /// Acceleration \[side / tick^2\].
    pub force: f64,
    /// Reach \[side\].
    pub within: f64,
}

impl Terms {
    pub fn new(scene: &Scene) -> Result<Terms, SceneError> {
        for (term, declared, built) in [
            ("agitation", scene.agitation.is_some(), built::AGITATION),
            ("bond", scene.bond.is_some(), built::BOND),
            ("contact", scene.contact.is_some(), built::CONTACT),
            ("drag", scene.drag.is_some(), built::DRAG),
            ("enclosure", scene.enclosure.is_some(), built::ENCLOSURE),
        ] {
            if declared && !built {
                return Err(SceneError::NotBuilt { term });
            }
        }
        let side = positive("the side of a block", scene.block.side)?;
        let mass = positive("the mass of a block", scene.block.mass)?;
        let tick = positive("the tick", scene.tick)?;
        let length = |what, value: f64| number(what, value / side);
        let speed = |what, value: f64| number(what, value * tick / side);
        let reach = |what, reach: &Reach| {
            Ok::<Pull, SceneError>(Pull {
                force: number(what, reach.force * tick * tick / (mass * side))?,
                within: length(what, reach.within)?,
            })
        };
        Ok(Terms {
            hemisphere: match &scene.enclosure {
                Some(Enclosure::Hemisphere { radius, wall }) => Some(Hemisphere {
                    radius: length("the radius of the enclosure", *radius)?,
                    stiffness: number("the wall", wall * tick * tick / mass)?,
                }),
                None => None,
            },
            kicks: match &scene.agitation {
                Some(Agitation::Kicks { speed: (low, high) }) => Some(Kicks {
                    speed: (speed("a kick", *low)?, speed("a kick", *high)?),
                }),
                None => None,
            },
            drag: match &scene.drag {
                Some(drag) => Some(number("the drag", drag.rate * tick)?),
                None => None,
            },
            contact: match &scene.contact {
                Some(contact) => Some(Contact {
                    law: match contact.law {
                        ContactLaw::Rigid { restitution } => ContactLaw::Rigid {
                            restitution: number("the restitution", restitution)?,
                        },
                        ContactLaw::Compliant { stiffness, damping } => ContactLaw::Compliant {
                            stiffness: number("the stiffness", stiffness * tick * tick / mass)?,
                            damping: number("the damping", damping * tick / mass)?,
                        },
                    },
                    friction: number("the friction", contact.friction)?,
                }),
                None => None,
            },
            bond: match &scene.bond {
                Some(Bond::Attract {
                    pull,
                    align,
                    anchor,
                }) => Some(Magnet {
                    pull: reach("the pull", pull)?,
                    align: match align {
                        Some(align) => Some(reach("the aligning force", align)?),
                        None => None,
                    },
                    measure: anchor.measure,
                    within: length("the anchoring distance", anchor.within)?,
                    cos_tilt: libm::cos(number("the anchoring tilt", anchor.tilt)?),
                }),
                None => None,
            },
        })
    }
}

impl Terms {
    /// Whether the steps are short enough.
    ///
    /// # Errors
    /// If a spring would turn by more than one radian in a step: from two on it gains energy.
    pub fn check(&self, settings: &Settings) -> Result<(), SceneError> {
        let substeps = f64::from(settings.substeps.max(1));
        let Some(shell) = self.hemisphere else {
            return Ok(());
        };
        let radians = shell.stiffness.sqrt();
        if radians > substeps {
            let (what, substeps) = ("the wall", radians.ceil() as u64);
            return Err(SceneError::TooStiff { what, substeps });
        }
        Ok(())
    }
}

/// A number that single precision can hold, and is not negative.
fn number(what: &'static str, value: f64) -> Result<f64, SceneError> {
    if value >= 0.0 && value <= f64::from(f32::MAX) {
        Ok(value)
    } else {
        Err(SceneError::NotANumber { what, value })
    }
}

fn positive(what: &'static str, value: f64) -> Result<f64, SceneError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(SceneError::NotANumber { what, value })
    }
}
