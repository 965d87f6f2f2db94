//! Values of a scene in units of its own.
use super::super::Scene;

/// Units that make the side of a block, its inertial mass and the tick 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockUnits {
    /// \[m\]
    pub side: f64,
    /// Mass of a block and of the fluid that it takes along \[kg\].
    pub mass: f64,
    /// \[s\]
    pub tick: f64,
}

impl BlockUnits {
    /// Those of a scene.
    pub fn from_scene(scene: &Scene) -> BlockUnits {
        BlockUnits {
            side: scene.block.side,
            mass: scene.inertial_mass(),
            tick: scene.tick,
        }
    }

    /// \[m\] in sides.
    pub fn length(self, value: f64) -> f64 {
        value / self.side
    }

    /// \[kg\] in blocks.
    pub fn mass(self, value: f64) -> f64 {
        value / self.mass
    }

    /// \[s\] in ticks.
    pub fn time(self, value: f64) -> f64 {
        value / self.tick
    }

    /// \[m/s\] in sides per tick.
    pub fn speed(self, value: f64) -> f64 {
        value * self.tick / self.side
    }

    /// Sides per tick in \[m/s\].
    pub(crate) fn speed_si(self, value: f64) -> f64 {
        value * self.side / self.tick
    }

    /// \[N\] in sides per tick^2, as an acceleration of a block.
    pub fn force(self, value: f64) -> f64 {
        value * self.tick * self.tick / (self.mass * self.side)
    }

    /// \[N/m\] per tick^2.
    pub fn stiffness(self, value: f64) -> f64 {
        value * self.tick * self.tick / self.mass
    }

    /// \[N s/m\] per tick.
    pub fn damping(self, value: f64) -> f64 {
        value * self.tick / self.mass
    }

    /// \[1/s\] per tick.
    pub fn rate(self, value: f64) -> f64 {
        value * self.tick
    }

    /// \[kg m^2\] in blocks times sides^2.
    pub fn inertia(self, value: f64) -> f64 {
        value / (self.mass * self.side * self.side)
    }

    /// \[m/s^2\] in sides per tick^2.
    pub fn acceleration(self, value: f64) -> f64 {
        value * self.tick * self.tick / self.side
    }

    /// \[kg/m^3\] in blocks per side^3.
    pub fn density(self, value: f64) -> f64 {
        value * self.side.powi(3) / self.mass
    }

    /// \[Pa s\] in blocks per side and tick.
    pub fn viscosity(self, value: f64) -> f64 {
        value * self.side * self.tick / self.mass
    }

    /// \[Pa\] in blocks per side and tick^2.
    pub fn pressure(self, value: f64) -> f64 {
        value * self.side * self.tick * self.tick / self.mass
    }

    /// \[m^3/s\] in sides^3 per tick.
    pub fn flow(self, value: f64) -> f64 {
        value * self.tick / self.side.powi(3)
    }

    /// \[Pa s/m^3\] in blocks per side^4 and tick.
    pub fn resistance(self, value: f64) -> f64 {
        self.pressure(value) / self.flow(1.0)
    }

    /// \[N s\] in sides per tick, as a change of a block's velocity.
    pub fn impulse(self, value: f64) -> f64 {
        value * self.tick / (self.mass * self.side)
    }

    /// \[J\] in blocks times sides^2 per tick^2.
    pub fn energy(self, value: f64) -> f64 {
        value * self.tick * self.tick / (self.mass * self.side * self.side)
    }

    /// \[W\] in blocks times sides^2 per tick^3.
    pub fn power(self, value: f64) -> f64 {
        self.energy(value) * self.tick
    }

    /// \[m^2/s\] in sides^2 per tick.
    pub fn diffusion(self, value: f64) -> f64 {
        value * self.tick / (self.side * self.side)
    }
}
