//! The clauses of what is around the blocks.
use super::super::groups::rms_of_range;
use super::super::medium::BOLTZMANN;
use super::super::{Agitation, Drag, Flow, Fluid, Jets, Scene, Stir, Strength, Turbulence};
use super::value::{Kind, Values};
use super::write::{self, write};
use super::{Law, Term};

impl Values {
    pub fn gravity(&self, gravity: f64, scene: &Scene) -> Term {
        let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
        let mut values = vec![self.of(Kind::Acceleration, "g", "gravity", gravity)];
        let (meaning, equation) = match density {
            None => ("pulls every free block down", "v' = -g z"),
            Some(density) => {
                let borne = density * scene.block.side.powi(3) / scene.block.mass;
                values.push(self.of(Kind::Number, "ρ a³ / m", "borne by the fluid", borne));
                (
                    "pulls every free block down, and its fluid bears it up",
                    "v' = -(1 - ρ a³ / m) g z",
                )
            }
        };
        Term {
            clause: "gravity",
            text: format!("gravity {}", write(gravity, &write::ACCELERATION)),
            laws: vec![Law {
                meaning,
                equation: Some(equation),
                values,
            }],
        }
    }

    pub fn fluid(&self, fluid: &Fluid) -> Term {
        let mut fields = Vec::new();
        let mut laws = Vec::new();
        if let Some(density) = fluid.density {
            fields.push(format!("density {}", write(density, &write::DENSITY)));
            laws.push(Law {
                meaning: "drag of a wake, on the motion relative to the fluid",
                equation: Some(
                    "m v' = -ρ a² |v - u| (v - u) / 2; I ω' = -ρ a⁵ |ω - w| (ω - w) / 32",
                ),
                values: vec![self.of(Kind::Density, "ρ", "density", density)],
            });
        }
        if let Some(viscosity) = fluid.viscosity {
            fields.push(format!("viscosity {}", write(viscosity, &write::VISCOSITY)));
            laws.push(Law {
                meaning: "Stokes' drag of a cube, on the motion relative to the fluid",
                equation: Some("m v' = -6 π η 0.6607 a (v - u); I ω' = -6 η a³ (ω - w)"),
                values: vec![self.of(Kind::Viscosity, "η", "viscosity", viscosity)],
            });
        }
        Term {
            clause: "fluid",
            text: format!("fluid {{ {} }}", fields.join("  ")),
            laws,
        }
    }

    pub fn flow(&self, flow: &Flow) -> Term {
        match flow {
            Flow::Stir(stir) => self.stir(stir),
            Flow::Jets(jets) => self.jets(jets),
        }
    }

    fn stir(&self, stir: &Stir) -> Term {
        let rev = stir.rate / std::f64::consts::TAU;
        let mut text = format!(
            "flow stir {{ radius {}  rate {}",
            write(stir.radius, &write::LENGTH),
            write(stir.rate, &write::TURNS)
        );
        let mut values = vec![
            self.of(Kind::Length, "r", "radius of the ring", stir.radius),
            self.of(Kind::Rate, "Ω", "rate of the ring", stir.rate),
            self.of(Kind::Number, "Ω / 2π", "turns a second", rev),
            self.of(
                Kind::Number,
                "f",
                "part of it that the fluid takes",
                stir.follow,
            ),
        ];
        if let Some((force, power)) = stir.force.zip(stir.power()) {
            text.push_str(&format!("  force {}", write(force, &write::FORCE)));
            values.push(self.of(Kind::Force, "F", "force on the ring", force));
            values.push(self.of(Kind::Power, "P", "power, F r Ω", power));
        }
        let follow = write(stir.follow, &write::NUMBER);
        text.push_str(&format!("  follow {follow} }}"));
        Term {
            clause: "flow",
            text,
            laws: vec![Law {
                meaning: "the fluid turns about the vertical axis: as a whole within the ring, \
                          without vorticity outside",
                equation: Some(
                    "u = f Ω s, beyond r f Ω r² / s; its pressure keeps it on the circle",
                ),
                values,
            }],
        }
    }

    fn jets(&self, jets: &Jets) -> Term {
        Term {
            clause: "flow",
            text: format!(
                "flow jets {{ count {}  flow {}  nozzle {} }}",
                jets.count,
                write(jets.flow, &write::FLOW),
                write(jets.nozzle, &write::LENGTH)
            ),
            laws: vec![Law {
                meaning: "round turbulent jets from the wall to the middle, evenly around",
                equation: Some("u = U min(1, 6.2 D / s) exp(-ln 2 (q / max(0.094 s, D / 2))²)"),
                values: vec![
                    self.of(Kind::Number, "J", "jets", f64::from(jets.count)),
                    self.of(Kind::Flow, "Q", "flow through all", jets.flow),
                    self.of(Kind::Length, "D", "diameter of a tube", jets.nozzle),
                    self.of(Kind::Speed, "U", "speed at a tube", jets.speed()),
                ],
            }],
        }
    }

    pub fn agitation(&self, agitation: &Agitation, scene: &Scene) -> Term {
        match agitation {
            Agitation::Kicks { speed } => self.kicks(*speed),
            Agitation::Turbulence(turbulence) => self.turbulence(turbulence, scene),
            Agitation::Brownian { temperature } => self.brownian(*temperature, scene),
        }
    }

    fn kicks(&self, (low, high): (f64, f64)) -> Term {
        let range = if low == high {
            write(low, &write::SPEED)
        } else {
            // A zero has the unit of what it goes up to.
            let unit = if low == 0.0 {
                &write::NUMBER
            } else {
                &write::SPEED
            };
            format!("{} .. {}", write(low, unit), write(high, &write::SPEED))
        };
        Term {
            clause: "agitation",
            text: format!("agitation kicks {{ speed {range} }}"),
            laws: vec![Law {
                meaning: "an impulse through the centre of every free block, once a tick",
                equation: Some(
                    "v += s n, s uniform in [u, w], n isotropic; j² = (u² + u w + w²) / 3",
                ),
                values: vec![
                    self.of(Kind::Speed, "u", "least change of speed", low),
                    self.of(Kind::Speed, "w", "most change of speed", high),
                    self.of(
                        Kind::Speed,
                        "j",
                        "rms change of speed",
                        rms_of_range(low, high),
                    ),
                ],
            }],
        }
    }

    fn turbulence(&self, turbulence: &Turbulence, scene: &Scene) -> Term {
        let strength = match turbulence.strength {
            Strength::Speed(speed) => format!("speed {}", write(speed, &write::SPEED)),
            Strength::Intensity(part) => format!("intensity {}", write(part, &write::NUMBER)),
        };
        let speed = turbulence.speed(scene.flow.as_ref());
        let mut text = format!(
            "agitation turbulence {{ {strength}  length {}",
            write(turbulence.length, &write::LENGTH)
        );
        if let Some(time) = turbulence.time {
            text.push_str(&format!("  time {}", write(time, &write::TIME)));
        }
        let vertical = write(turbulence.vertical, &write::NUMBER);
        text.push_str(&format!("  vertical {vertical} }}"));
        let mut values = vec![
            self.of(Kind::Speed, "σ", "rms speed in a level direction", speed),
            self.of(Kind::Length, "ℓ", "size of an eddy", turbulence.length),
            self.of(
                Kind::Number,
                "α",
                "vertical over level speed",
                turbulence.vertical,
            ),
        ];
        if speed > 0.0 {
            values.push(self.of(Kind::Time, "T", "time of an eddy", turbulence.time(speed)));
        }
        Term {
            clause: "agitation",
            text,
            laws: vec![Law {
                meaning: "the fluid moves in eddies without sources, which come and go by chance",
                equation: Some("<u(x, t) u(x, t + s)> = σ² exp(-s / T), wave length 2 ℓ, Gaussian"),
                values,
            }],
        }
    }

    fn brownian(&self, temperature: f64, scene: &Scene) -> Term {
        let mut values = vec![self.of(Kind::Temperature, "T", "temperature", temperature)];
        if let Some(viscosity) = scene.fluid.as_ref().and_then(|fluid| fluid.viscosity) {
            let diffusion = BOLTZMANN * temperature / Fluid::friction(viscosity, scene.block.side);
            values.push(self.of(Kind::Diffusion, "D", "diffusion coefficient", diffusion));
        }
        Term {
            clause: "agitation",
            text: format!(
                "agitation brownian {{ temperature {} }}",
                write(temperature, &write::TEMPERATURE)
            ),
            laws: vec![Law {
                meaning: "fluctuations that balance the viscous drag, of place and of orientation",
                equation: Some("<x²> = 2 D t with D = k T / (6 π η 0.6607 a), Einstein's relation"),
                values,
            }],
        }
    }

    pub fn drag(&self, drag: &Drag) -> Term {
        Term {
            clause: "drag",
            text: format!("drag {{ rate {} }}", write(drag.rate, &write::RATE)),
            laws: vec![Law {
                meaning: "slows the centre of every free block",
                equation: Some("v' = -γ v, by v *= exp(-γ dt) in each step"),
                values: vec![self.of(Kind::Rate, "γ", "rate", drag.rate)],
            }],
        }
    }
}
