//! The scene in block units: side 1, mass 1, and the tick as the unit of time.
//!
//! Single precision and contact settings then mean the same for a block of 10 um and of 20 cm.
use stochc_ir::scene::{
    Agitation, Anchor, BOLTZMANN, Bond, ContactLaw, Enclosure, Flow, Fluid, Measure, Reach, Scene,
};
use stochc_ir::table::Plate;

use super::SceneError;
use super::ambient::response;
use crate::settings::Settings;

/// The terms that this build can compute: without one, its code is unreachable and left out.
pub(crate) mod built {
    pub const AGITATION: bool = cfg!(feature = "agitation");
    pub const BOND: bool = cfg!(feature = "bond");
    pub const CONTACT: bool = cfg!(feature = "contact");
    pub const DRAG: bool = cfg!(feature = "drag");
    pub const ENCLOSURE: bool = cfg!(feature = "enclosure");
    pub const FLUID: bool = cfg!(feature = "fluid");
    pub const GRAVITY: bool = cfg!(feature = "gravity");
}

/// The terms in force; `None` is a term that does not exist.
#[derive(Clone, Debug)]
pub(crate) struct Terms {
    pub shell: Option<Shell>,
    pub kicks: Option<Kicks>,
    /// Rate of the linear drag \[1 / tick\].
    pub drag: Option<f64>,
    /// Acceleration of gravity less buoyancy, downward \[side / tick^2\].
    pub weight: Option<f64>,
    pub fluid: Option<Resistance>,
    pub flow: Option<Stream>,
    pub eddies: Option<Eddies>,
    /// Of a degree of freedom, k T \[side^2 / tick^2\].
    pub thermal: Option<f64>,
    pub contact: Option<Contact>,
    pub bond: Option<Magnet>,
}

/// An elastic shell about a point over the middle of the plate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shell {
    /// Farther from its centre, the centre of a block is pushed back \[side\].
    pub radius: f64,
    /// Of its centre \[side\].
    pub height: f64,
    /// Acceleration per depth \[1 / tick^2\].
    pub stiffness: f64,
}

impl Shell {
    /// Height of the level plane in which rings and jets are \[side\]: that of the middle of a ball, or
    /// half of that of a hemisphere.
    pub fn halfway(&self) -> f64 {
        if self.height > 0.0 {
            self.height
        } else {
            self.radius / 2.0
        }
    }
}

/// What a fluid does to a block that moves through it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Resistance {
    /// Rate of the viscous drag on velocity \[1 / tick\] and on spin; 0 without viscosity.
    pub viscous: (f64, f64),
    /// Deceleration over the square of the speed \[1 / side\], and of the spin \[1 / rad\]; 0 without density.
    pub wake: (f64, f64),
    /// Mass of the displaced fluid; 0 without density.
    pub displaced: f64,
}

/// How a fluid flows on the average.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stream {
    /// About the vertical axis.
    Vortex {
        /// Of the part that turns as a whole \[side\].
        radius: f64,
        /// Of that part \[rad / tick\].
        rate: f64,
    },
    /// From the shell towards its middle, in a level plane.
    Jets {
        count: u8,
        /// At a tube \[side / tick\].
        speed: f64,
        /// Of a tube \[side\].
        diameter: f64,
        /// Of the tubes' ends from the middle \[side\].
        distance: f64,
        /// Of the plane \[side\].
        height: f64,
    },
}

/// A random field of velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eddies {
    /// Rms in each level direction \[side / tick\].
    pub speed: f64,
    /// Vertical rms over that.
    pub vertical: f64,
    /// \[rad / side\]
    pub wavenumber: f64,
    /// Part of an eddy that is left after a tick.
    pub left: f64,
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

/// How a face captures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Magnet {
    pub law: Attraction,
    pub measure: Measure,
    /// Anchoring distance \[side\].
    pub within: f64,
    /// Cosine of the greatest tilt at which a block is anchored.
    pub cos_tilt: f64,
}

/// What a face does to a block in its reach.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Attraction {
    /// A face that is on pulls.
    Switched { pull: Pull, align: Option<Pull> },
    /// Every face pulls every other one.
    Passive(Passive),
    /// A face that is open draws fluid, and pulls what closes it.
    Suction(Suction),
}

/// Magnets in every face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passive {
    /// Of two faces that touch \[side / tick^2\].
    pub hold: f64,
    /// Of two opposite dipoles then \[side\].
    pub depth: f64,
    /// Reach \[side\].
    pub within: f64,
    /// Change of velocity of a block that is rejected \[side / tick\].
    pub impulse: f64,
}

/// Faces with valves, and what drives the fluid, in block units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Suction {
    /// Pressure drop that the pump can make \[1 / tick^2\], as the acceleration of a block of which it
    /// acts on one face.
    pub head: f64,
    /// Hydraulic resistances \[1 / tick\].
    pub supply: f64,
    pub valve: f64,
    pub passage: f64,
    /// Closer than this, a block closes the face \[side\].
    pub seal: f64,
}

impl Contact {
    /// Its law where a force leaves only this part of its effect in a step: what drag takes is not there to
    /// be parted.
    pub fn law_with(&self, response: f64) -> ContactLaw {
        match self.law {
            ContactLaw::Rigid { restitution } => ContactLaw::Rigid { restitution },
            ContactLaw::Compliant { stiffness, damping } => ContactLaw::Compliant {
                stiffness: stiffness * response,
                damping: damping * response,
            },
        }
    }
}

impl Magnet {
    /// Beyond this distance between the centres of two faces, nothing is felt \[side\].
    pub fn reach(&self) -> f64 {
        match self.law {
            Attraction::Switched { pull, .. } => pull.within,
            Attraction::Passive(passive) => passive.within,
            Attraction::Suction(suction) => suction.seal.max(self.anchoring()),
        }
    }

    /// Beyond this distance between the centres of two faces, no block is anchored \[side\].
    pub fn anchoring(&self) -> f64 {
        match self.measure {
            Measure::Centres => self.within,
            Measure::Gap => self.within.hypot(0.5),
        }
    }
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
    /// The terms of a scene around a plate.
    pub fn new(scene: &Scene, plate: &Plate) -> Result<Terms, SceneError> {
        let fluid = scene.fluid.is_some() || scene.flow.is_some();
        for (term, declared, built) in [
            ("agitation", scene.agitation.is_some(), built::AGITATION),
            ("bond", scene.bond.is_some(), built::BOND),
            ("contact", scene.contact.is_some(), built::CONTACT),
            ("drag", scene.drag.is_some(), built::DRAG),
            ("enclosure", scene.enclosure.is_some(), built::ENCLOSURE),
            ("fluid", fluid, built::FLUID),
            ("gravity", scene.gravity.is_some(), built::GRAVITY),
        ] {
            if declared && !built {
                return Err(SceneError::NotBuilt { term });
            }
        }
        let units = Units::of(scene)?;
        let shell = match &scene.enclosure {
            Some(enclosure) => Some(units.shell(enclosure, plate)?),
            None => None,
        };
        let kicks = match &scene.agitation {
            Some(Agitation::Kicks { speed: (low, high) }) => Some(Kicks {
                speed: (units.speed("a kick", *low)?, units.speed("a kick", *high)?),
            }),
            _ => None,
        };
        let thermal = match &scene.agitation {
            Some(Agitation::Brownian { temperature }) => {
                let energy = BOLTZMANN * temperature / units.mass;
                let speed = units.tick / units.side;
                Some(number("the temperature", energy * speed * speed)?)
            }
            _ => None,
        };
        Ok(Terms {
            shell,
            kicks,
            drag: match &scene.drag {
                Some(drag) => Some(number("the drag", drag.rate * units.tick)?),
                None => None,
            },
            weight: match scene.gravity {
                Some(gravity) => Some(units.weight(gravity, scene.fluid.as_ref())?),
                None => None,
            },
            fluid: match &scene.fluid {
                Some(fluid) => Some(units.resistance(fluid)?),
                None => None,
            },
            flow: match &scene.flow {
                Some(flow) => Some(units.stream(flow, shell)?),
                None => None,
            },
            eddies: units.eddies(scene)?,
            thermal,
            contact: match &scene.contact {
                Some(contact) => Some(units.contact(contact)?),
                None => None,
            },
            bond: match &scene.bond {
                Some(bond) => Some(units.magnet(bond)?),
                None => None,
            },
        })
    }
}

/// Makes numbers of values in SI units.
#[derive(Clone, Copy)]
struct Units {
    side: f64,
    mass: f64,
    tick: f64,
}

type Made<T> = Result<T, SceneError>;

impl Units {
    fn of(scene: &Scene) -> Made<Units> {
        Ok(Units {
            side: positive("the side of a block", scene.block.side)?,
            mass: positive("the mass of a block", scene.block.mass)?,
            tick: positive("the tick", scene.tick)?,
        })
    }

    fn length(self, what: &'static str, value: f64) -> Made<f64> {
        number(what, value / self.side)
    }

    fn speed(self, what: &'static str, value: f64) -> Made<f64> {
        number(what, value * self.tick / self.side)
    }

    fn force(self, what: &'static str, value: f64) -> Made<f64> {
        number(
            what,
            value * self.tick * self.tick / (self.mass * self.side),
        )
    }

    fn reach(self, what: &'static str, reach: &Reach) -> Made<Pull> {
        Ok(Pull {
            force: self.force(what, reach.force)?,
            within: self.length(what, reach.within)?,
        })
    }

    fn shell(self, enclosure: &Enclosure, plate: &Plate) -> Made<Shell> {
        let (radius, wall, inside) = match *enclosure {
            Enclosure::Hemisphere { radius, wall } => (radius, wall, 0.0),
            Enclosure::Sphere { radius, wall } => (radius, wall, self.side / 2.0),
        };
        Ok(Shell {
            radius: self.length("the radius of the enclosure", radius - inside)?,
            height: self.length(
                "the height of the enclosure",
                enclosure.centre_height(plate, self.side),
            )?,
            stiffness: number("the wall", wall * self.tick * self.tick / self.mass)?,
        })
    }

    fn weight(self, gravity: f64, fluid: Option<&Fluid>) -> Made<f64> {
        let density = fluid.and_then(|fluid| fluid.density).unwrap_or(0.0);
        let borne = density * self.side.powi(3) / self.mass;
        let down = gravity * self.tick * self.tick / self.side;
        number("gravity", down)?;
        number("buoyancy", down * borne)?;
        Ok(down * (1.0 - borne))
    }

    fn resistance(self, fluid: &Fluid) -> Made<Resistance> {
        let inertia = self.mass * self.side * self.side / 6.0;
        let viscosity = fluid.viscosity.unwrap_or(0.0);
        let density = fluid.density.unwrap_or(0.0);
        let what = "the drag of the fluid";
        Ok(Resistance {
            viscous: (
                number(
                    what,
                    Fluid::friction(viscosity, self.side) * self.tick / self.mass,
                )?,
                number(
                    what,
                    Fluid::turning_friction(viscosity, self.side) * self.tick / inertia,
                )?,
            ),
            wake: (
                number(
                    what,
                    Fluid::wake(density, self.side) * self.side / self.mass,
                )?,
                number(what, Fluid::turning_wake(density, self.side) / inertia)?,
            ),
            displaced: number(
                "the density of the fluid",
                density * self.side.powi(3) / self.mass,
            )?,
        })
    }

    fn stream(self, flow: &Flow, shell: Option<Shell>) -> Made<Stream> {
        Ok(match flow {
            Flow::Stir(stir) => Stream::Vortex {
                radius: self.length("the radius of the ring", stir.radius)?,
                rate: number("the rate of the ring", stir.follow * stir.rate * self.tick)?,
            },
            Flow::Jets(jets) => {
                let Some(shell) = shell else {
                    return Err(SceneError::NoWall);
                };
                let height = shell.halfway();
                let up = height - shell.height;
                Stream::Jets {
                    count: jets.count,
                    speed: self.speed("the speed of a jet", jets.speed())?,
                    diameter: self.length("the diameter of a tube", jets.nozzle)?,
                    distance: (shell.radius * shell.radius - up * up).sqrt() + 0.5,
                    height,
                }
            }
        })
    }

    fn eddies(self, scene: &Scene) -> Made<Option<Eddies>> {
        let Some(Agitation::Turbulence(turbulence)) = &scene.agitation else {
            return Ok(None);
        };
        let speed = turbulence.speed(scene.flow.as_ref());
        if speed == 0.0 {
            return Ok(None);
        }
        let length = self.length("the size of an eddy", turbulence.length)?;
        Ok(Some(Eddies {
            speed: self.speed("turbulence", speed)?,
            vertical: number("the vertical part of turbulence", turbulence.vertical)?,
            wavenumber: number("the size of an eddy", std::f64::consts::PI / length)?,
            left: libm::exp(-self.tick / turbulence.time(speed)),
        }))
    }

    fn contact(self, contact: &stochc_ir::scene::Contact) -> Made<Contact> {
        Ok(Contact {
            law: match contact.law {
                ContactLaw::Rigid { restitution } => ContactLaw::Rigid {
                    restitution: number("the restitution", restitution)?,
                },
                ContactLaw::Compliant { stiffness, damping } => ContactLaw::Compliant {
                    stiffness: number(
                        "the stiffness",
                        stiffness * self.tick * self.tick / self.mass,
                    )?,
                    damping: number("the damping", damping * self.tick / self.mass)?,
                },
            },
            friction: number("the friction", contact.friction)?,
        })
    }

    fn magnet(self, bond: &Bond) -> Made<Magnet> {
        let Anchor {
            measure,
            within,
            tilt,
        } = *bond.anchor();
        let law = match bond {
            Bond::Attract { pull, align, .. } => Attraction::Switched {
                pull: self.reach("the pull", pull)?,
                align: match align {
                    Some(align) => Some(self.reach("the aligning force", align)?),
                    None => None,
                },
            },
            Bond::Reject {
                magnets, impulse, ..
            } => Attraction::Passive(Passive {
                hold: self.force("the hold of the magnets", magnets.hold)?,
                depth: self.length("the depth of the magnets", magnets.depth)?,
                within: self.length("the reach of the magnets", magnets.within)?,
                impulse: self.speed("the impulse of a rejection", impulse / self.mass)?,
            }),
            Bond::Suction { pump, seal, .. } => {
                // In block units a pressure is the acceleration of a block on one face of which it acts.
                let resistance = |value: f64| {
                    number(
                        "a hydraulic resistance",
                        value * self.side.powi(4) * self.tick / self.mass,
                    )
                };
                Attraction::Suction(Suction {
                    head: self.force("the head of the pump", pump.head * self.side * self.side)?,
                    supply: resistance(pump.supply)?,
                    valve: resistance(pump.valve)?,
                    passage: resistance(pump.passage)?,
                    seal: self.length("the seal", *seal)?,
                })
            }
        };
        Ok(Magnet {
            law,
            measure,
            within: self.length("the anchoring distance", within)?,
            cos_tilt: libm::cos(number("the anchoring tilt", tilt)?),
        })
    }
}

impl Terms {
    /// Whether the steps are short enough.
    ///
    /// # Errors
    /// If a spring would turn by more than one radian in a step, or, slowed by drag, swing back by more than it
    /// was out: from twice as much on it gains energy.
    pub fn check(&self, settings: &Settings) -> Result<(), SceneError> {
        let substeps = settings.substeps.max(1);
        let Some(shell) = self.shell else {
            return Ok(());
        };
        // Drag takes up what it can of a step that is longer than it needs to slow a block.
        let drag = self.fluid.map_or(0.0, |fluid| fluid.viscous.0);
        let swings =
            |substeps: f64| shell.stiffness * response(drag / substeps) > substeps * substeps;
        if swings(f64::from(substeps)) {
            let (mut few, mut enough) = (f64::from(substeps), shell.stiffness.sqrt().ceil());
            while enough - few > 1.0 {
                let middle = ((few + enough) / 2.0).floor();
                // So large that there is no number between them.
                if middle <= few || middle >= enough {
                    break;
                }
                if swings(middle) {
                    few = middle;
                } else {
                    enough = middle;
                }
            }
            let (what, substeps) = ("the wall", enough as u64);
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
