//! A scene in block units: side 1, mass 1, and the tick as the unit of time.
//!
//! Single precision and contact settings then mean the same for a block of 10 um and of 20 cm.
use stochc_ir::scene::groups::BlockUnits;
use stochc_ir::scene::{
    Agitation, Anchor, BOLTZMANN, Bond, ContactLaw, Enclosure, Flow, Fluid, Reach, Scene,
};
use stochc_ir::table::Plate;

use super::SceneError;
use super::parameters::{
    Attraction, ContactParameters, Eddies, Kicks, Magnet, MeanFlow, Passive, Pull, Resistance,
    Shell, Suction, WorldParameters, built,
};
use crate::settings::takes_local_steps;

impl WorldParameters {
    /// The terms of a scene around a plate.
    pub fn new(scene: &Scene, plate: &Plate) -> Result<WorldParameters, SceneError> {
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
        let shell = made(&scene.enclosure, |enclosure| units.shell(enclosure, plate))?;
        let (mut kicks, mut thermal) = (None, None);
        match &scene.agitation {
            Some(Agitation::Kicks { speed: (low, high) }) => {
                let speed = (units.speed("a kick", *low)?, units.speed("a kick", *high)?);
                kicks = Some(Kicks { speed });
            }
            Some(Agitation::Brownian { temperature }) => {
                let energy = units.of.mass(BOLTZMANN * temperature);
                let speed = units.of.speed(1.0);
                thermal = Some(number("the temperature", energy * speed * speed)?);
            }
            _ => {}
        }
        let weight = |&gravity: &f64| units.weight(gravity, scene.fluid.as_ref());
        Ok(WorldParameters {
            local: takes_local_steps(scene),
            shell,
            kicks,
            drag: made(&scene.drag, |drag| {
                number("the drag", units.of.rate(drag.rate))
            })?,
            weight: made(&scene.gravity, weight)?,
            fluid: made(&scene.fluid, |fluid| units.resistance(fluid))?,
            flow: made(&scene.flow, |flow| units.stream(flow, shell))?,
            eddies: units.eddies(scene)?,
            thermal,
            contact: made(&scene.contact, |contact| units.contact(contact))?,
            bond: made(&scene.bond, |bond| units.magnet(bond))?,
        })
    }
}

/// Makes numbers of values in SI units, and sees that they are some.
#[derive(Clone, Copy)]
struct Units {
    of: BlockUnits,
}

type SceneResult<T> = Result<T, SceneError>;

/// A term that a scene need not have.
fn made<A, B>(term: &Option<A>, make: impl FnOnce(&A) -> SceneResult<B>) -> SceneResult<Option<B>> {
    term.as_ref().map(make).transpose()
}

impl Units {
    fn of(scene: &Scene) -> SceneResult<Units> {
        let of = BlockUnits::of(scene);
        positive("the side of a block", of.side)?;
        positive("the mass of a block", of.mass)?;
        positive("the tick", of.tick)?;
        Ok(Units { of })
    }

    fn length(self, what: &'static str, value: f64) -> SceneResult<f64> {
        number(what, self.of.length(value))
    }

    fn speed(self, what: &'static str, value: f64) -> SceneResult<f64> {
        number(what, self.of.speed(value))
    }

    fn force(self, what: &'static str, value: f64) -> SceneResult<f64> {
        number(what, self.of.force(value))
    }

    fn reach(self, what: &'static str, reach: &Reach) -> SceneResult<Pull> {
        Ok(Pull {
            force: self.force(what, reach.force)?,
            within: self.length(what, reach.within)?,
        })
    }

    fn shell(self, enclosure: &Enclosure, plate: &Plate) -> SceneResult<Shell> {
        let (radius, wall, inside) = match *enclosure {
            Enclosure::Hemisphere { radius, wall } => (radius, wall, 0.0),
            Enclosure::Sphere { radius, wall } => (radius, wall, self.of.side / 2.0),
        };
        Ok(Shell {
            radius: self.length("the radius of the enclosure", radius - inside)?,
            height: self.length(
                "the height of the enclosure",
                enclosure.centre_height(plate, self.of.side),
            )?,
            stiffness: number("the wall", self.of.stiffness(wall))?,
        })
    }

    fn weight(self, gravity: f64, fluid: Option<&Fluid>) -> SceneResult<f64> {
        let density = fluid.and_then(|fluid| fluid.density).unwrap_or(0.0);
        let borne = self.of.density(density);
        let down = self.of.acceleration(gravity);
        number("gravity", down)?;
        number("buoyancy", down * borne)?;
        Ok(down * (1.0 - borne))
    }

    fn resistance(self, fluid: &Fluid) -> SceneResult<Resistance> {
        let side = self.of.side;
        let viscosity = fluid.viscosity.unwrap_or(0.0);
        let density = fluid.density.unwrap_or(0.0);
        let what = "the drag of the fluid";
        let inertia = self.of.mass * side * side / 6.0;
        Ok(Resistance {
            viscous: (
                number(what, self.of.damping(Fluid::friction(viscosity, side)))?,
                number(
                    what,
                    Fluid::turning_friction(viscosity, side) * self.of.tick / inertia,
                )?,
            ),
            wake: (
                number(what, self.of.mass(Fluid::wake(density, side) * side))?,
                number(what, Fluid::turning_wake(density, side) / inertia)?,
            ),
            displaced: number("the density of the fluid", self.of.density(density))?,
        })
    }

    fn stream(self, flow: &Flow, shell: Option<Shell>) -> SceneResult<MeanFlow> {
        Ok(match flow {
            Flow::Stir(stir) => MeanFlow::Vortex {
                radius: self.length("the radius of the ring", stir.radius)?,
                rate: number(
                    "the rate of the ring",
                    self.of.rate(stir.follow * stir.rate),
                )?,
            },
            Flow::Jets(jets) => {
                let Some(shell) = shell else {
                    return Err(SceneError::NoWall);
                };
                let height = shell.halfway();
                let up = height - shell.height;
                MeanFlow::Jets {
                    count: jets.count,
                    speed: self.speed("the speed of a jet", jets.speed())?,
                    diameter: self.length("the diameter of a tube", jets.nozzle)?,
                    distance: (shell.radius * shell.radius - up * up).sqrt() + 0.5,
                    height,
                }
            }
        })
    }

    fn eddies(self, scene: &Scene) -> SceneResult<Option<Eddies>> {
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
            left: libm::exp(-self.of.tick / turbulence.time(speed)),
        }))
    }

    fn contact(self, contact: &stochc_ir::scene::Contact) -> SceneResult<ContactParameters> {
        Ok(ContactParameters {
            law: match contact.law {
                ContactLaw::Rigid { restitution } => ContactLaw::Rigid {
                    restitution: number("the restitution", restitution)?,
                },
                ContactLaw::Compliant { stiffness, damping } => ContactLaw::Compliant {
                    stiffness: number("the stiffness", self.of.stiffness(stiffness))?,
                    damping: number("the damping", self.of.damping(damping))?,
                },
            },
            friction: number("the friction", contact.friction)?,
        })
    }

    fn magnet(self, bond: &Bond) -> SceneResult<Magnet> {
        let Anchor {
            measure,
            within,
            tilt,
        } = *bond.anchor();
        let law = match bond {
            Bond::Attract { pull, align, .. } => Attraction::Switched {
                pull: self.reach("the pull", pull)?,
                align: made(align, |align| self.reach("the aligning force", align))?,
            },
            Bond::Reject {
                magnets, impulse, ..
            } => Attraction::Passive(Passive {
                hold: self.force("the hold of the magnets", magnets.hold)?,
                depth: self.length("the depth of the magnets", magnets.depth)?,
                within: self.length("the reach of the magnets", magnets.within)?,
                impulse: self.speed("the impulse of a rejection", self.of.mass(*impulse))?,
            }),
            Bond::Suction { pump, seal, .. } => {
                let side = self.of.side;
                // In block units a pressure is the acceleration of a block on one face of which it acts.
                let resistance = |value: f64| {
                    number(
                        "a hydraulic resistance",
                        value * side.powi(4) * self.of.tick / self.of.mass,
                    )
                };
                Attraction::Suction(Suction {
                    head: self.force("the head of the pump", pump.head * side * side)?,
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
            square_of_step: 0.0,
        })
    }
}

/// A number that single precision can hold, and is not negative.
fn number(what: &'static str, value: f64) -> SceneResult<f64> {
    if value >= 0.0 && value <= f64::from(f32::MAX) {
        Ok(value)
    } else {
        Err(SceneError::NotANumber { what, value })
    }
}

fn positive(what: &'static str, value: f64) -> SceneResult<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(SceneError::NotANumber { what, value })
    }
}
