//! Reads what the engine has made of the blocks, and says at once when that makes no sense.
use super::convert::{unit_quaternion, vector};
use super::{Block, RapierWorld};
use crate::world::Fault;

/// A faster block \[side / tick\] is a fault.
const MOST_SPEED: f32 = 100.0;

/// A block farther from the plate \[side\] is a fault: single precision resolves its place no more.
const FARTHEST: f32 = 1e5;

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
            if let Some(what) = block.absurdity() {
                let body = id as u32;
                return Err(Fault { body, what });
            }
        }
        Ok(())
    }
}

impl Block {
    /// What is wrong with it, if something is.
    fn absurdity(&self) -> Option<String> {
        let speed = self.velocity.norm();
        let spin = self.spin.norm();
        let far = self.position.norm();
        // What is not a number is not below anything.
        let sound = |value: f32, most: f32| value < most;
        if !sound(speed, MOST_SPEED) {
            Some(format!("its speed is {speed} sides per tick"))
        } else if !sound(spin, MOST_SPEED) {
            Some(format!("its spin is {spin} radians per tick"))
        } else if !sound(far, FARTHEST) || !self.rotation.coords.iter().all(|x| x.is_finite()) {
            Some(format!("it is {far} sides from the plate"))
        } else {
            None
        }
    }
}
