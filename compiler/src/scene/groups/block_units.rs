//! Values of a scene in units of its own.
use super::super::Scene;

/// Units in which the side of a block, its mass and the tick are 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockUnits {
    /// \[m\]
    side: f64,
    /// \[kg\]
    mass: f64,
    /// \[s\]
    tick: f64,
}

impl BlockUnits {
    /// Those of a scene.
    pub fn of(scene: &Scene) -> BlockUnits {
        BlockUnits {
            side: scene.block.side,
            mass: scene.block.mass,
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
    pub fn speed_si(self, value: f64) -> f64 {
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
}
