//! A scene in block units: block length 1, mass 1, and the tick as unit of time.
//!
//! Single precision and contact settings then suit blocks of 10 um and of 20 cm alike.
use nalgebra::Vector3;
use stochc_ir::scene::dimensionless::BlockUnits;
use stochc_ir::scene::schema::SchemaNumber;
use stochc_ir::scene::schema::numbers::*;
use stochc_ir::scene::{
    Agitation, Anchor, BOLTZMANN, Bond, ContactLaw, Enclosure, Flow, Fluid, Interior, Reach, Scene,
    Suction as SceneSuction, takes_local_steps,
};
use stochc_ir::table::Plate;

use super::SceneError;
use super::parameters::{
    Attraction, ContactParameters, Eddies, Kicks, Magnet, MeanFlow, Passive, Pull, Resistance,
    Suction, Wall, WorldParameters,
};

impl WorldParameters {
    /// Returns the terms of a scene around a plate, in block units.
    pub fn new(scene: &Scene, plate: &Plate) -> Result<WorldParameters, SceneError> {
        let units = Units::from_scene(scene)?;
        let wall = made(&scene.enclosure, |enclosure| {
            units.wall_of_enclosure(enclosure, plate, scene.contact.is_some())
        })?;
        let (mut kicks, mut thermal) = (None, None);
        match &scene.agitation {
            Some(Agitation::Kicks { speed: (low, high) }) => {
                let speed = (
                    units.number(&KICKS_MIN, *low)?,
                    units.number(&KICKS_MAX, *high)?,
                );
                kicks = Some(Kicks { speed });
            }
            Some(Agitation::Brownian { temperature }) => {
                let energy = units.of.mass(BOLTZMANN * temperature);
                let speed = units.of.speed(1.0);
                thermal = Some(checked(&TEMPERATURE, energy * speed * speed)?);
            }
            _ => {}
        }
        Ok(WorldParameters {
            local: takes_local_steps(scene),
            is_planar: scene.planar.is_some(),
            table: units.table(scene)?,
            wall,
            kicks,
            drag: made(&scene.drag, |drag| units.number(&DRAG_RATE, drag.rate))?,
            acceleration: units.acceleration(scene)?,
            fluid: made(&scene.fluid, |fluid| units.resistance(fluid))?,
            flow: made(&scene.flow, |flow| units.stream(flow, wall))?,
            eddies: units.eddies(scene)?,
            thermal,
            contact: made(&scene.contact, |contact| units.contact(contact))?,
            bond: made(&scene.bond, |bond| units.magnet(scene, bond))?,
        })
    }
}

/// Converter of values in SI units to validated block units.
#[derive(Clone, Copy)]
struct Units {
    of: BlockUnits,
}

type SceneResult<T> = Result<T, SceneError>;

/// Converts a term of a scene with `make`. Returns `None` if the term is absent.
fn made<A, B>(term: &Option<A>, make: impl FnOnce(&A) -> SceneResult<B>) -> SceneResult<Option<B>> {
    term.as_ref().map(make).transpose()
}

impl Units {
    fn from_scene(scene: &Scene) -> SceneResult<Units> {
        let of = BlockUnits::from_scene(scene);
        positive(&BLOCK_SIDE, of.side)?;
        positive(&BLOCK_MASS, of.mass)?;
        positive(&TICK, of.tick)?;
        Ok(Units { of })
    }

    /// Converts the value of a scene parameter to block units.
    fn number(self, number: &SchemaNumber, value: f64) -> SceneResult<f64> {
        checked(number, (number.kind.in_block_units)(self.of, value))
    }

    fn reach(self, [force, within]: [&SchemaNumber; 2], reach: &Reach) -> SceneResult<Pull> {
        Ok(Pull {
            force: self.number(force, reach.force)?,
            within: self.number(within, reach.within)?,
        })
    }

    fn wall_of_enclosure(
        self,
        enclosure: &Enclosure,
        plate: &Plate,
        has_solid_ground: bool,
    ) -> SceneResult<Wall> {
        let interior = enclosure.interior(plate, self.of);
        match interior {
            Interior::Ball { radius, height } => {
                checked(&ENCLOSURE_RADIUS, radius)?;
                derived("the height of the enclosure", height)?;
            }
            Interior::Box { half, high, .. } => {
                checked(&ENCLOSURE_LENGTH, half[0])?;
                checked(&ENCLOSURE_WIDTH, half[1])?;
                checked(&ENCLOSURE_HEIGHT, high)?;
            }
            Interior::Cylinder { radius, high, .. } => {
                checked(&ENCLOSURE_RADIUS, radius)?;
                checked(&ENCLOSURE_HEIGHT, high)?;
            }
        }
        Ok(Wall {
            interior,
            has_solid_ground,
            stiffness: self.number(&ENCLOSURE_WALL, enclosure.wall())?,
        })
    }

    /// Returns the sum of the steady accelerations of a scene, or `None` without any.
    fn acceleration(self, scene: &Scene) -> SceneResult<Option<Vector3<f64>>> {
        // The table carries the blocks of a planar world.
        let gravity = scene.gravity.filter(|_| scene.planar.is_none());
        let weight = made(&gravity, |gravity| self.weight(*gravity, scene))?;
        let up = Vector3::from(scene.gravity_direction().map(|part| f64::from(-part)));
        Ok(weight.map(|weight| up * -weight))
    }

    /// Returns the deceleration by the table of a planar world.
    fn table(self, scene: &Scene) -> SceneResult<Option<f64>> {
        let friction = scene.table_friction().zip(scene.gravity);
        made(&friction, |&(friction, gravity)| {
            let weight = self.weight(gravity, scene)?.max(0.0);
            Ok(self.number(&TABLE_FRICTION, friction)? * weight)
        })
    }

    fn weight(self, gravity: f64, scene: &Scene) -> SceneResult<f64> {
        let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
        let borne = self.of.density(density.unwrap_or(0.0));
        let down = self.of.acceleration(gravity);
        checked(&GRAVITY, down)?;
        derived("buoyancy", down * borne)?;
        Ok(down * (self.of.mass(scene.block.mass) - borne))
    }

    fn resistance(self, fluid: &Fluid) -> SceneResult<Resistance> {
        let side = self.of.side;
        let viscosity = fluid.viscosity.unwrap_or(0.0);
        let density = fluid.density.unwrap_or(0.0);
        let what = "the drag of the fluid";
        let inertia = self.of.mass * side * side / 6.0;
        Ok(Resistance {
            viscous: (
                derived(what, self.of.damping(Fluid::friction(viscosity, side)))?,
                derived(
                    what,
                    Fluid::turning_friction(viscosity, side) * self.of.tick / inertia,
                )?,
            ),
            wake: (
                derived(what, self.of.mass(Fluid::wake(density, side) * side))?,
                derived(what, Fluid::turning_wake(density, side) / inertia)?,
            ),
            displaced: self.number(&FLUID_DENSITY, density)?
                * (1.0 + fluid.added_mass.unwrap_or(0.0)),
        })
    }

    fn stream(self, flow: &Flow, wall: Option<Wall>) -> SceneResult<MeanFlow> {
        Ok(match flow {
            Flow::Stir(stir) => MeanFlow::Vortex {
                radius: self.number(&STIR_RADIUS, stir.radius)?,
                rate: self.number(&STIR_RATE, stir.follow * stir.rate)?,
            },
            Flow::Jets(jets) => {
                let Some(wall) = wall else {
                    return Err(SceneError::NoWall);
                };
                let height = wall.interior.halfway();
                let round = [f64::INFINITY; 2];
                let (distance, walls) = match wall.interior {
                    Interior::Ball {
                        radius,
                        height: centre,
                    } => {
                        let up = height - centre;
                        ((radius * radius - up * up).sqrt() + 0.5, round)
                    }
                    Interior::Cylinder { radius, .. } => (radius + 0.5, round),
                    Interior::Box { half, .. } => (f64::INFINITY, half.map(|half| half + 0.5)),
                };
                MeanFlow::Jets {
                    count: jets.count,
                    speed: derived("the speed of a jet", self.of.speed(jets.speed()))?,
                    diameter: self.number(&JETS_NOZZLE, jets.nozzle)?,
                    distance,
                    walls,
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
        let length = self.number(&EDDY_LENGTH, turbulence.length)?;
        Ok(Some(Eddies {
            speed: derived("turbulence", self.of.speed(speed))?,
            vertical: self.number(&EDDY_VERTICAL, turbulence.vertical)?,
            wavenumber: checked(&EDDY_LENGTH, std::f64::consts::PI / length)?,
            left: libm::exp(-self.of.tick / turbulence.time(speed)),
        }))
    }

    fn contact(self, contact: &stochc_ir::scene::Contact) -> SceneResult<ContactParameters> {
        Ok(ContactParameters {
            law: match contact.law {
                ContactLaw::Rigid { restitution } => ContactLaw::Rigid {
                    restitution: self.number(&CONTACT_RESTITUTION, restitution)?,
                },
                ContactLaw::Compliant { stiffness, damping } => ContactLaw::Compliant {
                    stiffness: self.number(&CONTACT_STIFFNESS, stiffness)?,
                    damping: self.number(&CONTACT_DAMPING, damping)?,
                },
            },
            friction: self.number(&CONTACT_FRICTION, contact.friction)?,
        })
    }

    fn magnet(self, scene: &Scene, bond: &Bond) -> SceneResult<Magnet> {
        let (law, anchor) = match bond {
            Bond::Attract {
                pull,
                align,
                anchor,
                ..
            } => {
                let law = Attraction::Switched {
                    pull: self.reach([&PULL, &PULL_WITHIN], pull)?,
                    align: made(align, |align| self.reach([&ALIGN, &ALIGN_WITHIN], align))?,
                };
                (law, anchor.clone())
            }
            Bond::Reject {
                magnets,
                impulse,
                anchor,
            } => {
                let law = Attraction::Passive(Passive {
                    hold: self.number(&HOLD, magnets.hold)?,
                    depth: self.number(&DEPTH, magnets.depth)?,
                    within: self.number(&REACH, magnets.within)?,
                    impulse: checked(&IMPULSE, self.of.speed(self.of.mass(*impulse)))?,
                });
                (law, anchor.clone())
            }
            Bond::Suction { .. } => self.suction(scene)?,
        };
        let Anchor {
            measure,
            within,
            tilt,
            sampled,
        } = anchor;
        Ok(Magnet {
            law,
            measure,
            within: self.number(&ANCHOR, within)?,
            cos_tilt: libm::cos(self.number(&ANCHOR_TILT, tilt)?),
            sampled,
            square_of_step: 0.0,
        })
    }
}

impl Units {
    /// Returns the suction of a scene and its condition of a capture.
    fn suction(self, scene: &Scene) -> SceneResult<(Attraction, Anchor)> {
        let missing = || not_a_number(&quoted(&VALVE), f64::NAN);
        let suction = SceneSuction::from_scene(scene).ok_or_else(missing)?;
        let valve = suction.valve.ok_or_else(missing)?;
        positive(&VALVE, valve)?;
        let side = self.of.side;
        // In block units, a pressure equals the acceleration of a block whose single face it acts
        // on.
        let resistance = |number, value: f64| {
            checked(number, value * side.powi(4) * self.of.tick / self.of.mass)
        };
        let law = Attraction::Suction(Suction {
            head: checked(&HEAD, self.of.force(suction.head * side * side))?,
            supply: resistance(&SUPPLY, suction.supply)?,
            valve: resistance(&VALVE, valve)?,
            passage: resistance(&PASSAGE, suction.passage.unwrap_or(valve))?,
            seal: self.number(&SEAL, suction.seal)?,
        });
        Ok((law, suction.anchor))
    }
}

/// Returns a scene parameter in block units if it is not negative and fits in single precision.
fn checked(number: &SchemaNumber, value: f64) -> SceneResult<f64> {
    derived(&quoted(number), value)
}

/// Returns a derived quantity if it is not negative and fits in single precision.
fn derived(what: &str, value: f64) -> SceneResult<f64> {
    if value >= 0.0 && value <= f64::from(f32::MAX) {
        Ok(value)
    } else {
        Err(not_a_number(what, value))
    }
}

fn positive(number: &SchemaNumber, value: f64) -> SceneResult<()> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(not_a_number(&quoted(number), value))
    }
}

fn quoted(number: &SchemaNumber) -> String {
    format!("`{}`", number.name())
}

fn not_a_number(what: &str, value: f64) -> SceneError {
    let what = what.to_owned();
    SceneError::NotANumber { what, value }
}
