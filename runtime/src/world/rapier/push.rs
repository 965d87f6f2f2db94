//! Everything that changes velocities, other than contacts.
use rapier3d::glamx::Vec3;

use super::RapierWorld;
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
        for (id, block) in self.blocks.iter_mut().enumerate() {
            if block.anchored.is_some() {
                continue;
            }
            if let Some(shell) = self.terms.hemisphere {
                let distance = block.position.length();
                if distance > shell.radius {
                    let depth = distance - shell.radius;
                    block.velocity -= block.position * (shell.stiffness * depth / distance * dt);
                }
            }
            if let Some(((low, high), step)) = &mut draws {
                let [speed, height, azimuth, _] = step.block(id as u32);
                let speed = (*low + (*high - *low) * unit(speed)) as f32;
                block.velocity += speed * Vec3::from(direction(height, azimuth));
            }
            if let Some(factor) = drag {
                block.velocity *= factor;
            }
            // Only what has changed, because the engine looks at everything that was touched.
            let handle = self.handles[id];
            let known = &self.engine.bodies[handle];
            let (linear, angular) = (known.linvel(), known.angvel());
            if linear != block.velocity || angular != block.spin {
                let body = &mut self.engine.bodies[handle];
                body.set_linvel(block.velocity, false);
                body.set_angvel(block.spin, false);
            }
        }
    }

    /// The magnets' part, on every block in reach.
    fn pull(&mut self, dt: f32) {
        let Some(magnet) = &self.terms.bond else {
            return;
        };
        for sighting in &self.sightings {
            let block = &mut self.blocks[sighting.body as usize];
            let target = &self.active[sighting.active].target;
            let push = target.push(&sighting.near, block.position, block.rotation, magnet);
            block.velocity += push.linear * dt;
            block.spin += push.angular * dt;
        }
    }
}
