//! Everything that changes velocities, other than contacts.
use nalgebra::Vector3;

use super::RapierWorld;
use super::convert::{vec3, vector};
use crate::draw::{direction, unit};

impl RapierWorld {
    /// Magnets, shell, kicks if it is time for them, and drag, over one substep.
    pub(super) fn push(&mut self, kick: bool) {
        let dt = 1.0 / self.substeps as f32;
        self.pull(dt);
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
                    let stiffness = shell.stiffness as f32;
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

    /// The magnets' part, on every block in reach.
    fn pull(&mut self, dt: f32) {
        let Some(faces) = &self.faces else {
            return;
        };
        let mut pushes = Vec::new();
        faces.pull(&mut self.blocks, |id, push| pushes.push((id, push)));
        for (id, push) in pushes {
            let block = &mut self.blocks.0[id as usize];
            block.velocity += push.linear * dt;
            block.spin += push.angular * dt;
        }
    }
}
