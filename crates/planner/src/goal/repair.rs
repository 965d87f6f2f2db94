//! Plans the rest of a run: the blocks at its end exist at the start, and the missing ones are
//! planned.
use std::collections::BTreeSet;

use stochc_compiler::{Checked, DeclaredShapes, Program};
use stochc_ir::Cell;

use super::completion::existing;
use super::definition::Goal;
use super::existing_structure::{ExistingStructure, NoRepair};
use super::from_program::{scene_of, seats};
use super::no_goal::NoGoal;
use super::scenes::WrittenScenes;

impl Goal {
    /// Returns the final shape of a program as a goal. This is the shape with this name, the shape
    /// claimed last, or the cells of all captures. If the last claim is `yields at least`, the goal
    /// also contains the other blocks at the end of its phase.
    ///
    /// # Errors
    /// If there is no such shape.
    pub fn from_end(
        checked: &Checked,
        program: &Program,
        shape: Option<&str>,
    ) -> Result<Goal, NoGoal> {
        let plan = &program.plan;
        let phases = plan.phases.iter().enumerate();
        let claims =
            phases.flat_map(|(number, phase)| phase.claims.iter().map(move |it| (number, it)));
        let last_claim = claims.last();
        let claimed = last_claim.map(|(_, claim)| checked.symbols.word(claim.shape));
        let mut goal = match shape.or(claimed) {
            Some(shape) => match DeclaredShapes::new(checked).seen_from(plan, shape) {
                Some(known) => Goal::from_shape(checked, known, Some(program))?,
                None => Goal::from_program(checked, Some(shape))?,
            },
            None => {
                let last = plan.phases.len().checked_sub(1);
                let built = last.map_or(Vec::new(), |last| existing(program, last));
                let cells = built.into_iter().map(|(block, _)| block.cell);
                Goal {
                    scenes: WrittenScenes::new(checked),
                    ..Goal::from_cells(&plan.name, cells.collect())
                }
            }
        };
        if let Some((phase, _)) = last_claim.filter(|(_, claim)| shape.is_none() && claim.at_least)
        {
            let built = existing(program, phase).into_iter();
            let cells = goal
                .cells
                .iter()
                .copied()
                .chain(built.map(|(block, _)| block.cell));
            let cells: BTreeSet<Cell> = cells.collect();
            goal = Goal {
                scenes: WrittenScenes::new(checked),
                ..Goal::from_cells(&plan.name, cells.into_iter().collect())
            };
        }
        goal.plate = Some(plan.plate.clone());
        goal.seeds = seats(plan);
        goal.scene = scene_of(program);
        Ok(goal)
    }

    /// Sets the existing structure of the goal. See [`ExistingStructure::repair`].
    ///
    /// # Errors
    /// If no block is missing, or a block cannot be released.
    pub fn stand_on(
        &mut self,
        structure: &ExistingStructure,
        dead: &BTreeSet<&str>,
    ) -> Result<(), NoRepair> {
        let repair = structure.repair(&self.cells, dead)?;
        let full: BTreeSet<Cell> = repair.existing.iter().map(|block| block.cell).collect();
        if self.cells.iter().all(|cell| full.contains(cell)) {
            return Err(match repair.released.len() {
                0 => NoRepair::Complete,
                1 => NoRepair::OneTooMany,
                count => NoRepair::TooMany(count),
            });
        }
        self.repair = repair;
        Ok(())
    }
}
