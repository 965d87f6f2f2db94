//! What is around the blocks and acts on each of them alone: gravity, and a fluid with its drag, its
//! flow, its eddies and its heat. The same for every world of rigid blocks, in double precision.
//!
//! With a viscous drag of the rate γ, a constant force acts on average over a step of length dt with
//! the factor φ = (1 - exp(-γ dt)) / (γ dt) on the velocity. Velocities are averages over a step then, and the
//! laws that last, terminal velocity and diffusion, hold for steps of any length.
mod brownian;
mod drag;
mod mean_flow;
mod turbulence;

use nalgebra::Vector3;

use brownian::Brownian;
use drag::StepDrag;
pub(crate) use drag::{Response, mean as response};
use turbulence::TurbulenceField;

use super::blocks::Motion;
use super::parameters::{MeanFlow, WorldParameters};

/// How a fluid moves at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct LocalFlow {
    velocity: Vector3<f64>,
    /// Half of its vorticity: as fast a small body turns that is taken along.
    spin: Vector3<f64>,
    /// Of its parts, by pressure; without eddies and jets.
    acceleration: Vector3<f64>,
}

/// A face that draws fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sink {
    /// Of the face.
    pub centre: Vector3<f64>,
    /// Outward.
    pub normal: Vector3<f64>,
    /// \[side^3 / tick\]
    pub flow: f64,
}

/// The surroundings of a scene.
#[derive(Debug)]
pub(crate) struct ExternalForces {
    weight: Option<f64>,
    drag: Option<StepDrag>,
    mean_flow: Option<MeanFlow>,
    eddies: Option<TurbulenceField>,
    heat: Option<Brownian>,
    displaced: f64,
    /// Length of a step \[tick\].
    dt: f64,
}

stochc_ir::state! {
    () ExternalForces;
    values: ;
    parts: eddies;
    same: weight, drag, mean_flow, heat, displaced, dt
}

impl ExternalForces {
    /// `None` where nothing is around the blocks.
    pub fn new(
        parameters: &WorldParameters,
        substeps: u32,
        seed: u64,
        run: u64,
    ) -> Option<ExternalForces> {
        let (weight, fluid) = (parameters.weight, parameters.fluid);
        if weight.is_none() && fluid.is_none() {
            return None;
        }
        let dt = 1.0 / f64::from(substeps);
        Some(ExternalForces {
            weight,
            drag: fluid.map(|fluid| StepDrag::new(&fluid, dt)),
            mean_flow: parameters.flow.filter(|_| fluid.is_some()),
            eddies: (parameters.eddies)
                .filter(|_| fluid.is_some())
                .map(|eddies| TurbulenceField::new(&eddies, seed, run)),
            heat: fluid
                .zip(parameters.thermal)
                .map(|(fluid, energy)| Brownian::new(&fluid, energy, dt, seed, run)),
            displaced: fluid.map_or(0.0, |fluid| fluid.displaced),
            dt,
        })
    }

    /// How much of a force's effect is left in a step.
    pub fn response(&self) -> Response {
        self.drag
            .as_ref()
            .map_or(Response::FREE, StepDrag::response)
    }

    /// Begins a tick, or goes on in it; steps are counted from the beginning of the run.
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

    /// What one step makes of a free block's velocity and spin, but for the heat.
    ///
    /// `span`: for how many steps the weight acts; more than one where blocks take steps of different lengths, which they do in no
    /// fluid.
    pub fn act(&self, motion: &mut Motion, sinks: &[Sink], span: f64) {
        let response = self.response();
        let mut force = Vector3::zeros();
        if let Some(weight) = self.weight {
            force.z -= weight;
        }
        if let Some(drag) = &self.drag {
            let wind = self.wind(motion.position, sinks);
            force += wind.acceleration * self.displaced;
            drag.slow(motion, wind.velocity, wind.spin);
        }
        motion.velocity += force * (self.dt * span * response.linear);
    }

    /// Whether the fluid has any heat.
    pub fn has_heat(&self) -> bool {
        self.heat.is_some()
    }

    /// What the heat of a step makes of a free block's velocity and spin.
    pub fn shake(&mut self, id: u32, motion: &mut Motion) {
        if let Some(heat) = &mut self.heat {
            heat.shake(id, motion);
        }
    }

    fn wind(&self, place: Vector3<f64>, sinks: &[Sink]) -> LocalFlow {
        let mut wind = LocalFlow::default();
        if let Some(flow) = &self.mean_flow {
            mean_flow::add(flow, place, &mut wind);
        }
        if let Some(eddies) = &self.eddies {
            eddies.add(place, &mut wind);
        }
        for sink in sinks {
            wind.velocity += sink.draw(place);
        }
        wind
    }
}

impl Sink {
    /// Velocity of the fluid that it draws, Q / (2 pi d^2) in front of a wall; as at half a side, where a block's
    /// centre cannot come closer.
    fn draw(&self, place: Vector3<f64>) -> Vector3<f64> {
        let way = self.centre - place;
        if way.dot(&self.normal) >= 0.0 {
            return Vector3::zeros();
        }
        let distance = way.norm();
        let near = distance.max(0.5);
        way * (self.flow / (std::f64::consts::TAU * near * near) / distance.max(1e-9))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_sphere_before_a_sink_lets_its_flow_through() {
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
