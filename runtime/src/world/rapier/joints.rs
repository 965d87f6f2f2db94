//! Bonds between free blocks as joints of the engine.
use std::collections::BTreeMap;

use rapier3d::dynamics::{FixedJointBuilder, ImpulseJointHandle};

use super::bodies::EngineBodies;

/// Joints by the numbers of their blocks.
#[derive(Debug, Default)]
pub(super) struct Joints(BTreeMap<(u32, u32), ImpulseJointHandle>);

impl Joints {
    /// Updates the joints to these bonds, at the blocks' current places.
    ///
    /// Joined blocks do not collide with each other.
    pub fn follow(
        &mut self,
        EngineBodies {
            engine, handles, ..
        }: &mut EngineBodies,
        bonds: impl Iterator<Item = (u32, u32)>,
    ) {
        let mut old = std::mem::take(&mut self.0);
        for bond in bonds {
            let handle = old.remove(&bond).unwrap_or_else(|| {
                let (a, b) = (handles[bond.0 as usize], handles[bond.1 as usize]);
                let (first, second) = (engine.bodies[a].position(), engine.bodies[b].position());
                let joint = FixedJointBuilder::new()
                    .local_frame1(first.inverse() * *second)
                    .contacts_enabled(false);
                engine.insert_impulse_joint(a, b, joint)
            });
            self.0.insert(bond, handle);
        }
        for handle in old.into_values() {
            engine.remove_impulse_joint(handle);
        }
    }
}
