//! Block units of a scene.
use super::super::Scene;

/// Units based on the block length, the inertial mass of a block, and the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockUnits {
    /// Block length \[m\].
    pub side: f64,
    /// Mass of a block plus its added mass of fluid \[kg\].
    pub mass: f64,
    /// Duration of a tick \[s\].
    pub tick: f64,
}

impl BlockUnits {
    /// Returns the units of a scene.
    pub fn from_scene(scene: &Scene) -> BlockUnits {
        BlockUnits {
            side: scene.block.side,
            mass: scene.inertial_mass(),
            tick: scene.tick,
        }
    }

    /// Converts \[m\] to block lengths.
    pub fn length(self, value: f64) -> f64 {
        value / self.side
    }

    /// Converts \[kg\] to block masses.
    pub fn mass(self, value: f64) -> f64 {
        value / self.mass
    }

    /// Converts \[s\] to ticks.
    pub fn time(self, value: f64) -> f64 {
        value / self.tick
    }

    /// Converts \[m/s\] to block lengths per tick.
    pub fn speed(self, value: f64) -> f64 {
        value * self.tick / self.side
    }

    /// Converts block lengths per tick to \[m/s\].
    pub(crate) fn speed_si(self, value: f64) -> f64 {
        value * self.side / self.tick
    }

    /// Converts \[N\] to block lengths per tick^2, as an acceleration of a block.
    pub fn force(self, value: f64) -> f64 {
        value * self.tick * self.tick / (self.mass * self.side)
    }

    /// Converts \[N/m\] to 1 / tick^2.
    pub fn stiffness(self, value: f64) -> f64 {
        value * self.tick * self.tick / self.mass
    }

    /// Converts \[N s/m\] to 1 / tick.
    pub fn damping(self, value: f64) -> f64 {
        value * self.tick / self.mass
    }

    /// Converts \[1/s\] to 1 / tick.
    pub fn rate(self, value: f64) -> f64 {
        value * self.tick
    }

    /// Converts \[kg m^2\] to block masses times block lengths^2.
    pub fn inertia(self, value: f64) -> f64 {
        value / (self.mass * self.side * self.side)
    }

    /// Converts \[m/s^2\] to block lengths per tick^2.
    pub fn acceleration(self, value: f64) -> f64 {
        value * self.tick * self.tick / self.side
    }

    /// Converts \[kg/m^3\] to block masses per block length^3.
    pub fn density(self, value: f64) -> f64 {
        value * self.side.powi(3) / self.mass
    }

    /// Converts \[Pa s\] to block masses per block length and tick.
    pub fn viscosity(self, value: f64) -> f64 {
        value * self.side * self.tick / self.mass
    }

    /// Converts \[Pa\] to block masses per block length and tick^2.
    pub fn pressure(self, value: f64) -> f64 {
        value * self.side * self.tick * self.tick / self.mass
    }

    /// Converts \[m^3/s\] to block lengths^3 per tick.
    pub fn flow(self, value: f64) -> f64 {
        value * self.tick / self.side.powi(3)
    }

    /// Converts \[Pa s/m^3\] to block masses per block length^4 and tick.
    pub fn resistance(self, value: f64) -> f64 {
        self.pressure(value) / self.flow(1.0)
    }

    /// Converts \[N s\] to block lengths per tick, as a velocity change of a block.
    pub fn impulse(self, value: f64) -> f64 {
        value * self.tick / (self.mass * self.side)
    }

    /// Converts \[J\] to block masses times block lengths^2 per tick^2.
    pub fn energy(self, value: f64) -> f64 {
        value * self.tick * self.tick / (self.mass * self.side * self.side)
    }

    /// Converts \[W\] to block masses times block lengths^2 per tick^3.
    pub fn power(self, value: f64) -> f64 {
        self.energy(value) * self.tick
    }

    /// Converts \[m^2/s\] to block lengths^2 per tick.
    pub fn diffusion(self, value: f64) -> f64 {
        value * self.tick / (self.side * self.side)
    }
}
