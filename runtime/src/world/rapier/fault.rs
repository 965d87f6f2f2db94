//! Reads what the engine has made of the blocks, and says at once when that makes no sense.
use super::convert::{unit_quaternion, vector};
use super::{Block, RapierWorld};
use crate::world::Fault;
use crate::world::limits::Limits;

impl RapierWorld {
    /// Reads what the engine has made of the blocks.
    pub(super) fn read(&mut self) -> Result<(), Fault> {
        let quarantine = self.engine.physics_pipeline.quarantine();
        if !quarantine.is_empty() {
            let lost = |handle| quarantine.bodies().contains(handle);
            let body = self.handles.iter().position(lost).unwrap_or(0) as u32;
            let what = "its position or speed is not a number".to_owned();
            return Err(Fault { body, what });
        }
        for (id, (block, &handle)) in self.blocks.0.iter_mut().zip(&self.handles).enumerate() {
            if block.anchored.is_some() {
                continue;
            }
            let body = &self.engine.bodies[handle];
            block.position = vector(body.translation());
            block.rotation = unit_quaternion(*body.rotation());
            block.velocity = vector(body.linvel());
            block.spin = vector(body.angvel());
            if let Some(what) = block.absurdity(&self.limits) {
                let body = id as u32;
                return Err(Fault { body, what });
            }
        }
        Ok(())
    }
}

impl Block {
    /// What is wrong with it, if something is.
    fn absurdity(&self, limits: &Limits) -> Option<String> {
        let [speed, spin, far] =
            [self.velocity, self.spin, self.position].map(|v| f64::from(v.norm()));
        let length = f64::from(self.rotation.coords.norm());
        limits.excess(speed, spin, far, length)
    }
}
