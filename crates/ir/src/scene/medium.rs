//! What is around the blocks: a fluid, how it flows, and what chance does.
use serde::{Deserialize, Serialize};

/// What the blocks float in; what is `None` has no effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fluid {
    /// Of its mass \[kg/m^3\]: for buoyancy and for the drag that grows with the square of the speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Dynamic \[Pa s\]: for the drag that grows with the speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<f64>,
    /// Mass of fluid that an accelerating block takes along, over the mass that it displaces. Needs a density.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub added_mass: Option<f64>,
}

/// Boltzmann's constant \[J/K\], exact.
pub const BOLTZMANN: f64 = 1.380649e-23;

/// Hydrodynamic radius of a cube \[side\]: its electrostatic capacity, by J. B. Hubbard and J. F. Douglas,
/// Phys. Rev. E 47, R2983 (1993), good to about a percent.
const CUBE: f64 = 0.660_678;

impl Fluid {
    /// Returns the mass of fluid that an accelerating cube takes along \[kg\].
    pub fn taken_along(&self, side: f64) -> f64 {
        let displaced = self.density.unwrap_or(0.0) * side.powi(3);
        self.added_mass.unwrap_or(0.0) * displaced
    }

    /// Stokes' friction of a cube that moves through a viscous fluid \[N s/m\].
    pub fn friction(viscosity: f64, side: f64) -> f64 {
        6.0 * std::f64::consts::PI * viscosity * CUBE * side
    }

    /// Stokes' friction of a cube that turns in a viscous fluid \[N m s\]: that of the ball of its volume,
    /// 8 pi eta r^3 with 4 pi r^3 / 3 = side^3.
    pub fn turning_friction(viscosity: f64, side: f64) -> f64 {
        6.0 * viscosity * side.powi(3)
    }

    /// Force of the drag of a cube's wake over the square of its speed \[N s^2/m^2\]: a drag coefficient
    /// of 1.
    pub fn wake(density: f64, side: f64) -> f64 {
        density * side * side / 2.0
    }

    /// Torque of the drag of a turning cube over the square of its spin \[N m s^2\]: that of MuJoCo's
    /// boxes, rho r^5 for a half side r.
    pub fn turning_wake(density: f64, side: f64) -> f64 {
        density * (side / 2.0).powi(5)
    }
}

/// How the fluid flows on the average.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Flow {
    /// A ring of rods turns about the vertical axis and takes the fluid with it.
    Stir(Stir),
    /// Tubes along the wall blow fluid in.
    Jets(Jets),
}

/// A turning ring of rods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stir {
    /// Of the ring \[m\].
    pub radius: f64,
    /// How fast it turns \[rad/s\], counterclockwise seen from above.
    pub rate: f64,
    /// Tangential force on the ring \[N\], for the power that it takes; moves nothing by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Speed of the fluid at the ring, as a part of the ring's, 0 to 1.
    pub follow: f64,
}

impl Stir {
    /// Speed of the ring's rods \[m/s\].
    pub fn speed(&self) -> f64 {
        self.radius * self.rate
    }

    /// Power that the ring gives to the fluid \[W\]: P = F 2 pi r rev/s.
    pub fn power(&self) -> Option<f64> {
        self.force.map(|force| force * self.speed())
    }
}

/// Round jets at the wall, evenly about the vertical axis, halfway up the enclosure, aimed at its middle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jets {
    /// How many, 1 to 64.
    pub count: u8,
    /// Through all of them together \[m^3/s\].
    pub flow: f64,
    /// Diameter of a tube \[m\].
    pub nozzle: f64,
}

impl Jets {
    /// Speed at which the fluid leaves a tube \[m/s\].
    pub fn speed(&self) -> f64 {
        let area = std::f64::consts::FRAC_PI_4 * self.nozzle * self.nozzle;
        self.flow / (f64::from(self.count) * area)
    }
}

impl Flow {
    /// The speed that drives it \[m/s\]: of the rods, or of the fluid that leaves a tube.
    pub fn speed(&self) -> f64 {
        match self {
            Flow::Stir(stir) => stir.speed(),
            Flow::Jets(jets) => jets.speed(),
        }
    }
}

/// What moves the free blocks by chance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agitation {
    /// Once a tick every free block gets an impulse through its centre of mass.
    Kicks {
        /// Range of the uniformly drawn change of speed \[m/s\]; its direction is isotropic.
        speed: (f64, f64),
    },
    /// The fluid moves in eddies and drags the blocks along.
    Turbulence(Turbulence),
    /// The molecules of the fluid: fluctuations that balance its viscous drag.
    Brownian {
        /// \[K\]
        temperature: f64,
    },
}

/// Eddies: a random field of velocity without sources, Gaussian, correlated in space and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turbulence {
    /// How strong it is.
    #[serde(flatten)]
    pub strength: Strength,
    /// Size of an eddy \[m\]: half of the wave length.
    pub length: f64,
    /// Time in which an eddy is forgotten \[s\]; absent: the time to move by its size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Vertical rms velocity over that of each horizontal direction; 1 is isotropic.
    pub vertical: f64,
}

/// How strong turbulence is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// Rms velocity in each horizontal direction \[m/s\].
    Speed(f64),
    /// The same, as a part of the speed that drives the mean flow; see [`Flow::speed`].
    Intensity(f64),
}

impl Turbulence {
    /// Rms velocity in each horizontal direction \[m/s\]; none without a flow to be a part of.
    pub fn speed(&self, flow: Option<&Flow>) -> f64 {
        match self.strength {
            Strength::Speed(speed) => speed,
            Strength::Intensity(part) => part * flow.map_or(0.0, Flow::speed),
        }
    }

    /// Time in which an eddy is forgotten \[s\], at that speed.
    pub fn time(&self, speed: f64) -> f64 {
        self.time.unwrap_or(self.length / speed)
    }
}

/// Linear drag on the velocity of the centre of mass: v' = -rate v.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    /// \[1/s\]
    pub rate: f64,
}
