//! Consistency of tables and scene, both from a file.
use super::{Action, InvalidTables, Tables};
use crate::Face;
use crate::scene::{BondKind, Planar, Scene};

impl Tables {
    /// Validates tables from a file against a scene.
    ///
    /// # Errors
    ///
    /// If a field is inconsistent.
    pub fn validate_in(&self, scene: &Scene) -> Result<(), InvalidTables> {
        let bond = BondKind::from_scene(scene);
        if self.bond != bond {
            return Err(InvalidTables::Bond {
                tables: self.bond.name(),
                scene: bond.name(),
            });
        }
        let faces = bond.faces(scene.block.faces);
        if self.faces != faces {
            return Err(InvalidTables::SceneFaces {
                tables: self.faces,
                scene: faces,
            });
        }
        let layer = scene.planar.as_ref().map_or(0, |_| Planar::LAYER);
        if self.seeds().any(|(_, cell)| cell.z != layer) {
            return Err(InvalidTables::SeedCell);
        }
        let leaves_plane = |then| match then {
            Action::Magnetize { face, .. } => matches!(face, Face::Up | Face::Down),
            _ => false,
        };
        let mut rules = self.duties().flat_map(|duty| duty.rules());
        if scene.planar.is_some() && rules.any(|rule| leaves_plane(rule.then)) {
            return Err(InvalidTables::OutOfPlane);
        }
        let (needed, free) = (self.blocks_at_once(), u64::from(scene.free.count));
        if needed > free {
            return Err(InvalidTables::FreeBlocks { free, needed });
        }
        Ok(())
    }

    /// Returns the largest number of captured blocks at the end of any phase.
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
