//! Medium around the blocks: fluid, flow and agitation.
use serde::{Deserialize, Serialize};

/// Fluid around the blocks. Terms that are `None` have no effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fluid {
    /// Density \[kg/m^3\], for buoyancy and for quadratic drag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Dynamic viscosity \[Pa s\], for linear drag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<f64>,
    /// Ratio of added mass to displaced mass. Needs a density.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub added_mass: Option<f64>,
}

/// Boltzmann's constant \[J/K\], exact.
pub const BOLTZMANN: f64 = 1.380649e-23;

/// Hydrodynamic radius of a cube \[block lengths\], computed by `lab/published/cube_drag.py`.
///
/// # Source
///
/// The settling speeds of E. S. Pettyjohn and E. B. Christiansen, Chemical Engineering Progress 44,
/// 157 (1948), correspond to 0.673.
const CUBE_RADIUS: f64 = 0.675;

/// Stokes' torque on a rotating cube of edge 1, for unit viscosity and spin. Computed by
/// `lab/published/cube_drag.py`.
const CUBE_TORQUE: f64 = 8.07;

impl Fluid {
    /// Returns the added mass of a cube \[kg\].
    pub(crate) fn taken_along(&self, side: f64) -> f64 {
        let displaced = self.density.unwrap_or(0.0) * side.powi(3);
        self.added_mass.unwrap_or(0.0) * displaced
    }

    /// Returns Stokes' friction coefficient of a moving cube \[N s/m\].
    pub fn friction(viscosity: f64, side: f64) -> f64 {
        6.0 * std::f64::consts::PI * viscosity * CUBE_RADIUS * side
    }

    /// Returns Stokes' friction coefficient of a rotating cube \[N m s\].
    pub fn turning_friction(viscosity: f64, side: f64) -> f64 {
        CUBE_TORQUE * viscosity * side.powi(3)
    }

    /// Returns the wake drag of a cube, divided by its squared speed \[N s^2/m^2\], for a drag
    /// coefficient of 1.
    pub fn wake(density: f64, side: f64) -> f64 {
        density * side * side / 2.0
    }

    /// Returns the drag torque of a rotating cube, divided by its squared spin \[N m s^2\]: rho r^5
    /// for a half-side r, as in MuJoCo.
    pub fn turning_wake(density: f64, side: f64) -> f64 {
        density * (side / 2.0).powi(5)
    }
}

/// Mean flow of the fluid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Flow {
    /// A ring of rods rotates about the vertical axis and drives the fluid.
    Stir(Stir),
    /// Tubes at the wall blow fluid in.
    Jets(Jets),
}

/// Rotating ring of rods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stir {
    /// Radius of the ring \[m\].
    pub radius: f64,
    /// Angular velocity \[rad/s\], counterclockwise seen from above.
    pub rate: f64,
    /// Tangential force on the ring \[N\]. Used only to compute the power of the ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Ratio of the fluid's speed at the ring to the speed of the ring, from 0 to 1.
    pub follow: f64,
}

impl Stir {
    /// Returns the speed of the rods \[m/s\].
    pub fn speed(&self) -> f64 {
        self.radius * self.rate
    }

    /// Returns the power that the ring transfers to the fluid \[W\]: the force on the ring times
    /// the speed of the rods. Returns `None` without a force.
    pub fn power(&self) -> Option<f64> {
        self.force.map(|force| force * self.speed())
    }
}

/// Round jets from the wall towards the centre, evenly spaced at half height of the enclosure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jets {
    /// Number of jets, 1 to 64.
    pub count: u8,
    /// Total flow \[m^3/s\].
    pub flow: f64,
    /// Diameter of a tube \[m\].
    pub nozzle: f64,
}

impl Jets {
    /// Returns the speed of the fluid at the tube's mouth \[m/s\].
    pub fn speed(&self) -> f64 {
        let area = std::f64::consts::FRAC_PI_4 * self.nozzle * self.nozzle;
        self.flow / (f64::from(self.count) * area)
    }
}

impl Flow {
    /// Returns the driving speed \[m/s\]: of the rods, or of the fluid at a tube's mouth.
    pub fn speed(&self) -> f64 {
        match self {
            Flow::Stir(stir) => stir.speed(),
            Flow::Jets(jets) => jets.speed(),
        }
    }
}

/// Random motion of the free blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agitation {
    /// Every free block gets a random impulse through its centre of mass once per tick.
    Kicks {
        /// Range of the uniformly distributed change of speed \[m/s\], in isotropic directions.
        speed: (f64, f64),
    },
    /// Eddies of the fluid carry the blocks.
    Turbulence(Turbulence),
    /// Thermal fluctuations, in balance with viscous drag.
    Brownian {
        /// Temperature \[K\].
        temperature: f64,
    },
}

/// Turbulence: a random velocity field without sources, Gaussian, correlated in space and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turbulence {
    /// Strength of the turbulence.
    #[serde(flatten)]
    pub strength: Strength,
    /// Size of an eddy \[m\]: half of the wavelength.
    pub length: f64,
    /// Correlation time of an eddy \[s\]. `None` for the size of the eddy divided by its speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Ratio of the vertical to the horizontal rms velocity. 1 is isotropic.
    pub vertical: f64,
}

/// Strength of turbulence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// Rms velocity in each horizontal direction \[m/s\].
    Speed(f64),
    /// Ratio of the rms velocity in each horizontal direction to the driving speed of the mean flow
    /// ([`Flow::speed`]).
    Intensity(f64),
}

impl Turbulence {
    /// Returns the rms velocity in each horizontal direction \[m/s\]. 0 for a relative strength
    /// without flow.
    pub fn speed(&self, flow: Option<&Flow>) -> f64 {
        match self.strength {
            Strength::Speed(speed) => speed,
            Strength::Intensity(part) => part * flow.map_or(0.0, Flow::speed),
        }
    }

    /// Returns the correlation time of an eddy at this speed \[s\].
    pub fn time(&self, speed: f64) -> f64 {
        self.time.unwrap_or(self.length / speed)
    }
}

/// Linear drag on the velocity of the centre of mass: v' = -rate v.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    /// Rate of the drag \[1/s\].
    pub rate: f64,
}
