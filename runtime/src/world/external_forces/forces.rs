//! All external forces on free blocks.
use nalgebra::Vector3;
use stochc_ir::scene::Planar;

use super::brownian::Brownian;
use super::drag::{Response, StepDrag};
use super::local_flow::LocalFlow;
use super::mean_flow;
use super::turbulence::TurbulenceField;
use crate::world::blocks::Motion;
use crate::world::parameters::{MeanFlow, WorldParameters};
use crate::world::unit_cube::INVERSE_INERTIA;

/// Sink of the flow: a face that draws fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sink {
    pub centre: Vector3<f64>,
    /// Outward normal.
    pub normal: Vector3<f64>,
    /// Flow rate \[block lengths^3 / tick\].
    pub flow: f64,
}

#[derive(Debug)]
pub(crate) struct ExternalForces {
    acceleration: Option<Vector3<f64>>,
    pub(super) drag: Option<StepDrag>,
    mean_flow: Option<MeanFlow>,
    pub(super) eddies: Option<TurbulenceField>,
    heat: Option<Brownian>,
    displaced: f64,
    /// Deceleration of a sliding block by the table of a planar world.
    table: Option<f64>,
    /// Length of a step \[tick\].
    pub(super) dt: f64,
}

stochc_ir::state! {
    () ExternalForces;
    values: ;
    parts: eddies;
    same: acceleration, drag, mean_flow, heat, displaced, table, dt
}

impl ExternalForces {
    /// Returns the external forces, or `None` if the scene has none.
    pub fn new(
        parameters: &WorldParameters,
        substeps: u32,
        seed: u64,
        run: u64,
    ) -> Option<ExternalForces> {
        let (acceleration, fluid) = (parameters.acceleration, parameters.fluid);
        if acceleration.is_none() && fluid.is_none() && parameters.table.is_none() {
            return None;
        }
        let dt = 1.0 / f64::from(substeps);
        Some(ExternalForces {
            acceleration,
            drag: fluid.map(|fluid| StepDrag::new(&fluid, dt)),
            mean_flow: parameters.flow.filter(|_| fluid.is_some()),
            eddies: (parameters.eddies)
                .filter(|_| fluid.is_some())
                .map(|eddies| TurbulenceField::new(&eddies, seed, run)),
            heat: fluid
                .zip(parameters.thermal)
                .map(|(fluid, energy)| Brownian::new(&fluid, energy, dt, seed, run)),
            displaced: fluid.map_or(0.0, |fluid| fluid.displaced),
            table: parameters.table,
            dt,
        })
    }

    /// Returns the effect of a constant force and torque over one step, relative to the effect
    /// without drag.
    pub fn response(&self) -> Response {
        self.drag
            .as_ref()
            .map_or(Response::FREE, StepDrag::response)
    }

    /// Begins a substep of a tick. `step` counts the substeps from the start of the run.
    pub fn begin(&mut self, tick: u64, substep: u32, step: u64) {
        if substep == 0
            && let Some(eddies) = &mut self.eddies
        {
            eddies.advance(tick);
        }
        if let Some(heat) = &mut self.heat {
            heat.begin(step);
        }
    }

    /// Applies one step of all forces except heat and the table to the velocity and spin of a free block.
    ///
    /// `span` is the number of steps during which the steady acceleration acts. It exceeds 1 only for steps of
    /// different lengths, which scenes with a fluid do not use.
    pub fn act(&self, motion: &mut Motion, sinks: &[Sink], span: f64) {
        let response = self.response();
        let mut force = self.acceleration.unwrap_or_else(Vector3::zeros);
        if let Some(drag) = &self.drag {
            let wind = self.wind(motion.position, sinks);
            force += wind.acceleration * self.displaced;
            drag.slow(motion, wind.velocity, wind.spin);
        }
        motion.velocity += force * (self.dt * span * response.linear);
    }

    /// Returns whether the scene has Brownian motion.
    pub fn has_heat(&self) -> bool {
        self.heat.is_some()
    }

    /// Applies the Brownian motion of a step to a free block.
    pub fn shake(&mut self, id: u32, motion: &mut Motion) {
        if let Some(heat) = &mut self.heat {
            heat.shake(id, motion);
        }
    }

    /// Returns whether the table of a planar world slows blocks.
    pub fn has_table(&self) -> bool {
        self.table.is_some()
    }

    /// Applies one step of friction with the table, after all other forces. `span` is as in
    /// [`ExternalForces::act`].
    ///
    /// Force and torque are on an ellipsoid whose semi-axes are their values in pure sliding and in
    /// pure turning. They are normal to it in the direction of the motion.
    ///
    /// # Source
    ///
    /// R. D. Howe and M. R. Cutkosky (1996), limit surfaces.
    pub fn rub(&self, motion: &mut Motion, span: f64) {
        let Some(deceleration) = self.table else {
            return;
        };
        let sliding = motion.velocity.norm().hypot(Planar::ARM * motion.spin.z);
        let change = deceleration * self.dt * span;
        if sliding <= change {
            (motion.velocity, motion.spin) = (Vector3::zeros(), Vector3::zeros());
            return;
        }
        let part = change / sliding;
        motion.velocity *= 1.0 - part;
        motion.spin *= 1.0 - INVERSE_INERTIA * Planar::ARM * Planar::ARM * part;
    }

    pub(super) fn wind(&self, position: Vector3<f64>, sinks: &[Sink]) -> LocalFlow {
        let mut wind = LocalFlow::default();
        if let Some(flow) = &self.mean_flow {
            mean_flow::add(flow, position, &mut wind);
        }
        if let Some(eddies) = &self.eddies {
            eddies.add(position, &mut wind);
        }
        for sink in sinks {
            wind.velocity += sink.draw(position);
        }
        wind
    }
}

impl Sink {
    /// Returns the velocity of the fluid at a position, towards the face that draws it. The speed
    /// is Q / (2 pi d^2) at distance d from a face in a wall. Below half a block length, the
    /// smallest possible distance of a block's centre, the speed is constant.
    fn draw(&self, position: Vector3<f64>) -> Vector3<f64> {
        let displacement = self.centre - position;
        if displacement.dot(&self.normal) >= 0.0 {
            return Vector3::zeros();
        }
        let distance = displacement.norm();
        let near = distance.max(0.5);
        displacement * (self.flow / (std::f64::consts::TAU * near * near) / distance.max(1e-9))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_through_a_hemisphere_is_that_of_the_sink() {
        let sink = Sink {
            centre: Vector3::new(1.0, 2.0, 3.0),
            normal: Vector3::x(),
            flow: 0.7,
        };
        for distance in [0.5, 1.0, 4.0] {
            let area = std::f64::consts::TAU * distance * distance;
            let along = Vector3::new(0.6, 0.0, 0.8);
            let drawn = sink.draw(sink.centre + along * distance);
            assert!((drawn + along * (0.7 / area)).norm() < 1e-12, "{distance}");
        }
        assert_eq!(sink.draw(sink.centre - Vector3::x()), Vector3::zeros());
    }
}
