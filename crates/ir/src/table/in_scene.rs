//! Consistency of tables and scene, both from a file.
use super::{Action, Tables};
use crate::scene::{BondKind, Scene};
use stochc_text::counted;

impl Tables {
    /// Validates tables from a file against a scene.
    ///
    /// # Errors
    ///
    /// A description of the inconsistent field.
    pub fn validate_in(&self, scene: &Scene) -> Result<(), String> {
        let bond = BondKind::from_scene(scene);
        if self.bond != bond {
            let (own, bond) = (self.bond.name(), bond.name());
            return Err(format!(
                "`tables.bond` is `{own}`, and the law of `scene.bond` is `{bond}`"
            ));
        }
        let faces = bond.faces(scene.block.faces);
        if self.faces != faces {
            let own = self.faces;
            return Err(format!(
                "`tables.faces` is {own}, which is {faces} by `scene.block.faces` and `scene.bond`"
            ));
        }
        let (needed, free) = (self.blocks_at_once(), u64::from(scene.free.count));
        if needed > free {
            let needed = counted(needed as usize, "block");
            return Err(format!(
                "`scene.free.count` is {free}, and the structure needs {needed} at once"
            ));
        }
        Ok(())
    }

    /// Returns the largest number of blocks held at the end of a phase.
    fn blocks_at_once(&self) -> u64 {
        let mut changes = vec![0_i64; self.phases.len()];
        for duty in self.duties() {
            let change = duty.rules().map(|rule| match rule.then {
                Action::Magnetize { .. } => 1,
                Action::SwitchOff { .. } => -1,
                _ => 0,
            });
            changes[duty.phase.0 as usize] += change.sum::<i64>();
        }
        let mut held = 0;
        let sizes = changes.into_iter().map(|change| {
            held += change;
            held.max(0) as u64
        });
        let most = sizes.max().unwrap_or(0);
        most.max(self.aggregate.map_or(0, u64::from))
    }
}
