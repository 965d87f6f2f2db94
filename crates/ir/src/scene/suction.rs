//! Suction with the defaults of all parameters that a scene does not give.
use std::f64::consts::{FRAC_PI_4, PI};

use super::schema::TILT;
use super::{Anchor, Bond, Fluid, Measure, Scene};

/// Parameters of [`Bond::Suction`], including defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Suction {
    /// Largest pressure of the pump \[Pa\].
    pub head: f64,
    /// Diameter of the opening in a face \[m\]. Default: half a block length.
    pub opening: f64,
    /// Resistance of pump and plate \[Pa s/m^3\]. Default: 0.
    pub supply: f64,
    /// Resistance of an open face \[Pa s/m^3\]. Default: an orifice with the diameter of the
    /// opening and a pressure drop of `head`. `None` if the default is unknown without a fluid.
    pub valve: Option<f64>,
    /// Resistance between the chambers of a block and its parent \[Pa s/m^3\]. Default: `valve`.
    pub passage: Option<f64>,
    /// Range of the pressure drop of the face \[m\]. Default: a quarter of the opening. The gap
    /// around the opening is then as large as the opening.
    pub seal: f64,
    /// Condition of a capture. Default: the face centres are closer than half of `seal`.
    pub anchor: Anchor,
}

impl Suction {
    /// Returns the suction of a scene. Returns `None` for other bonds.
    pub fn from_scene(scene: &Scene) -> Option<Suction> {
        let Some(Bond::Suction {
            pump, seal, anchor, ..
        }) = &scene.bond
        else {
            return None;
        };
        let opening = pump.opening.unwrap_or(scene.block.side / 2.0);
        let orifice = || Some(orifice(pump.head, opening, scene.fluid.as_ref()?));
        let valve = pump.valve.or_else(orifice);
        let seal = seal.unwrap_or(opening / 4.0);
        Some(Suction {
            head: pump.head,
            opening,
            supply: pump.supply.unwrap_or(0.0),
            valve,
            passage: pump.passage.or(valve),
            seal,
            anchor: anchor.clone().unwrap_or(Anchor {
                measure: Measure::Centres,
                within: seal / 2.0,
                tilt: TILT.0,
                sampled: false,
            }),
        })
    }

    /// Returns the flow through one open face of the plate \[m^3/s\]. Returns `None` without a
    /// known resistance.
    pub fn flow(&self) -> Option<f64> {
        Some(self.head / (self.supply + self.valve?))
    }

    /// Returns the speed of the fluid in the opening of one open face of the plate \[m/s\].
    pub fn speed(&self) -> Option<f64> {
        Some(self.flow()? / (FRAC_PI_4 * self.opening * self.opening))
    }

    /// Returns the distance from an open face of the plate where the flow has this speed \[m\].
    pub fn distance(&self, speed: f64) -> Option<f64> {
        Some((self.flow()? / (2.0 * PI * speed)).sqrt())
    }
}

/// Discharge coefficient of a sharp-edged orifice.
///
/// # Source
///
/// F. M. White, Fluid Mechanics (2011), section 6.12.
const DISCHARGE: f64 = 0.6;

/// Returns the resistance of an orifice at this pressure drop \[Pa s/m^3\].
///
/// The pressure drop is 3 η Q / r³ + ρ Q² / (2 (0.6 π r²)²), with the radius r.
///
/// # Source
///
/// The viscous term is by R. A. Sampson, Philosophical Transactions of the Royal Society A 182, 449
/// (1891).
fn orifice(drop: f64, diameter: f64, fluid: &Fluid) -> f64 {
    let radius = diameter / 2.0;
    let viscous = 3.0 * fluid.viscosity.unwrap_or(0.0) / radius.powi(3);
    let area = DISCHARGE * PI * radius * radius;
    let inertial = fluid.density.unwrap_or(0.0) / (2.0 * area * area);
    // R = drop / Q solves R² = viscous R + inertial drop.
    0.5 * (viscous + viscous.hypot(2.0 * (inertial * drop).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fluid(density: Option<f64>, viscosity: Option<f64>) -> Fluid {
        Fluid {
            density,
            viscosity,
            added_mass: None,
        }
    }

    #[test]
    fn an_orifice_passes_the_flow_of_bernoulli_or_of_sampson() {
        // 7.5 mm at 200 Pa in water: Q = 0.6 A √(2 Δp / ρ) is 1.002 L/min.
        let water = orifice(200.0, 7.5e-3, &fluid(Some(1007.0), None));
        assert!((200.0 / water * 6e4 - 1.0024).abs() < 1e-3, "{water}");
        // 5 um at 200 Pa: Q = r³ Δp / (3 η).
        let small = orifice(200.0, 5e-6, &fluid(None, Some(1e-3)));
        let flow = 2.5e-6_f64.powi(3) * 200.0 / 3e-3;
        assert!((200.0 / small / flow - 1.0).abs() < 1e-12);
        // At the same pressure drop, both losses together pass less than either one.
        let both = orifice(200.0, 1e-4, &fluid(Some(1000.0), Some(1e-3)));
        let flow = 200.0 / both;
        let (radius, area) = (5e-5_f64, DISCHARGE * PI * 5e-5 * 5e-5);
        let drop = 3e-3 * flow / radius.powi(3) + 1000.0 * flow * flow / (2.0 * area * area);
        assert!((drop / 200.0 - 1.0).abs() < 1e-12, "{drop}");
    }
}
