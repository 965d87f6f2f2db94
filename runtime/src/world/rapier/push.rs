//! Everything that changes velocities, other than contacts.
use nalgebra::Vector3;

use super::RapierWorld;
use super::convert::{vec3, vector};
use crate::draw::{direction, unit};
use crate::world::ambient::Response;
use crate::world::groups::Flock;
use crate::world::magnet::Faces;

impl RapierWorld {
    /// Surroundings, magnets, groups, shell, kicks if it is time for them, and drag, over one substep.
    pub(super) fn push(&mut self, substep: u32) {
        let kick = substep == 0;
        let dt = 1.0 / self.substeps as f32;
        let response = self.surround(substep);
        self.pull(dt, response);
        self.settle(f64::from(dt), response);
        let drag = self
            .terms
            .drag
            .map(|rate| libm::exp(-rate / f64::from(self.substeps)) as f32);
        let kicks = self.terms.kicks.filter(|_| kick);
        let mut draws = kicks.map(|kicks| (kicks.speed, self.kicks.step(self.tick)));
        for (id, block) in self.blocks.0.iter_mut().enumerate() {
            if block.anchored.is_some() {
                continue;
            }
            if let Some(shell) = self.terms.shell {
                let way = block.position - Vector3::z() * shell.height as f32;
                let distance = way.norm();
                let depth = distance - shell.radius as f32;
                if depth > 0.0 {
                    let stiffness = (shell.stiffness * response.linear) as f32;
                    block.velocity -= way * (stiffness * depth / distance * dt);
                }
            }
            if let Some(((low, high), step)) = &mut draws {
                let [speed, height, azimuth, _] = step.block(id as u32);
                let speed = (*low + (*high - *low) * unit(speed)) as f32;
                block.velocity += speed * Vector3::from(direction(height, azimuth));
            }
            if let Some(factor) = drag {
                block.velocity *= factor;
            }
            // Only what has changed, because the engine looks at everything that was touched.
            let handle = self.handles[id];
            let known = &self.engine.bodies[handle];
            let (linear, angular) = (vector(known.linvel()), vector(known.angvel()));
            if linear != block.velocity || angular != block.spin {
                let body = &mut self.engine.bodies[handle];
                body.set_linvel(vec3(block.velocity), false);
                body.set_angvel(vec3(block.spin), false);
            }
        }
    }

    /// What is around the blocks, for each of them alone.
    fn surround(&mut self, substep: u32) -> Response {
        let Some(ambient) = &mut self.ambient else {
            return Response::FREE;
        };
        let sinks = self.faces.as_mut().map(Faces::sinks).unwrap_or_default();
        ambient.begin(self.tick, substep, self.steps);
        for id in 0..self.blocks.0.len() as u32 {
            if self.blocks.0[id as usize].anchored.is_none() {
                let mut motion = self.blocks.motion(id);
                ambient.act(id, &mut motion, &sinks);
                self.blocks.set_velocity(id, motion.velocity, motion.spin);
            }
        }
        ambient.response()
    }

    /// The magnets' part, on every block in reach.
    fn pull(&mut self, dt: f32, response: Response) {
        let Some(faces) = &mut self.faces else {
            return;
        };
        let (linear, angular) = (response.linear as f32, response.angular as f32);
        let mut pushes = Vec::new();
        faces.pull(&mut self.blocks, |id, push| pushes.push((id, push)));
        for (id, push) in pushes {
            let block = &mut self.blocks.0[id as usize];
            block.velocity += push.linear * (dt * linear);
            block.spin += push.angular * (dt * angular);
        }
    }
}
