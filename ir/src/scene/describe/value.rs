//! Values with their units.
use serde::Serialize;

use super::super::groups::BlockUnits;

/// A value of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// What equations call it; empty: it is in none.
    pub symbol: &'static str,
    /// What it is.
    pub name: &'static str,
    /// In SI units, or in ticks.
    pub si: f64,
    /// That unit; empty: a pure number.
    pub unit: &'static str,
    /// In block units: the side a, the mass m and the tick τ are 1.
    pub block: f64,
    /// The unit among those; empty: a pure number.
    pub block_unit: &'static str,
}

/// What a value is one of.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Number,
    Angle,
    Time,
    Ticks,
    Length,
    Mass,
    Inertia,
    Speed,
    Force,
    Stiffness,
    Damping,
    Rate,
    Acceleration,
    Density,
    Viscosity,
    Pressure,
    Flow,
    Resistance,
    Impulse,
    Temperature,
    Power,
    Diffusion,
}

/// Makes values of a scene.
pub struct Values(pub BlockUnits);

impl Values {
    /// A value in SI units.
    pub fn of(&self, kind: Kind, symbol: &'static str, name: &'static str, si: f64) -> Value {
        let units = self.0;
        let (unit, block, block_unit) = match kind {
            Kind::Number => ("", si, ""),
            Kind::Angle => ("rad", si, "rad"),
            Kind::Time => ("s", units.time(si), "τ"),
            Kind::Ticks => ("ticks", si, "τ"),
            Kind::Length => ("m", units.length(si), "a"),
            Kind::Mass => ("kg", units.mass(si), "m"),
            Kind::Inertia => ("kg m²", units.inertia(si), "m a²"),
            Kind::Speed => ("m/s", units.speed(si), "a/τ"),
            Kind::Force => ("N", units.force(si), "m a/τ²"),
            Kind::Stiffness => ("N/m", units.stiffness(si), "m/τ²"),
            Kind::Damping => ("N s/m", units.damping(si), "m/τ"),
            Kind::Rate => ("1/s", units.rate(si), "1/τ"),
            Kind::Acceleration => ("m/s²", units.acceleration(si), "a/τ²"),
            Kind::Density => ("kg/m³", units.density(si), "m/a³"),
            Kind::Viscosity => ("Pa s", units.viscosity(si), "m/(a τ)"),
            Kind::Pressure => ("Pa", units.pressure(si), "m/(a τ²)"),
            Kind::Flow => ("m³/s", units.flow(si), "a³/τ"),
            Kind::Resistance => ("Pa s/m³", units.pressure(si) / units.flow(1.0), "m/(a⁴ τ)"),
            Kind::Impulse => ("N s", units.impulse(si), "m a/τ"),
            Kind::Temperature => ("K", si, "K"),
            Kind::Power => ("W", units.power(si), "m a²/τ³"),
            Kind::Diffusion => ("m²/s", units.diffusion(si), "a²/τ"),
        };
        Value {
            symbol,
            name,
            si,
            unit,
            block,
            block_unit,
        }
    }
}
