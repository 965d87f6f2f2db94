//! Shape that a plan builds.
use stochc_planner::{Goal, listed_cells};
use stochc_text::{counted, visible};

use super::offset::Offset;
use super::options::{LooseParts, PlanOptions};
use super::{scene, target};
use crate::exit::Failure;
use crate::host::Host;

/// Reads the target of a plan and applies the options to it.
///
/// # Errors
/// If the target cannot be read or contains no shape.
pub(super) fn goal(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let mut goal = target::read(options, host)?;
    scene::choose_declared(&mut goal, options, host);
    if let Some(Offset { east, north }) = options.offset {
        goal = (goal.moved(east, north))
            .ok_or_else(|| Failure::usage("--offset: the shape would be too far from the plate"))?;
    }
    placed(goal, options, host)
}

/// Applies the options for name, plate, offset and scene to a goal.
///
/// # Errors
/// If the scene does not exist, or the name is invalid.
pub(super) fn placed(
    mut goal: Goal,
    options: &PlanOptions<'_>,
    host: &dyn Host,
) -> Result<Goal, Failure> {
    if let Some(name) = options.name {
        goal.assembly = Some(assembly_name(name, &goal)?);
    }
    if let Some(plate) = options.seed_plate {
        goal.plate = Some(plate.plate.clone());
        goal.seeds = plate.seeds.clone();
    }
    scene::choose(&mut goal, options, host)?;
    hold_loose(&mut goal, options.loose, host);
    scene::enlarge(&mut goal, options, host)?;
    Ok(goal)
}

fn assembly_name(name: &str, goal: &Goal) -> Result<String, Failure> {
    let is_taken = name == goal.name || goal.declared_scenes().any(|scene| scene == name);
    match (target::is_name(name), is_taken) {
        (true, false) => Ok(name.to_owned()),
        (true, true) => Err(Failure::usage(format!(
            "--name: `{name}` is the name of the shape or of a scene already"
        ))),
        (false, _) => Err(Failure::usage(format!(
            "--name: `{}` is not a name; give letters, digits and `_`, no digit first and no keyword",
            visible(name)
        ))),
    }
}

/// Removes or supports loose parts, as the options require, and reports them.
fn hold_loose(goal: &mut Goal, loose: LooseParts, host: &dyn Host) {
    match loose {
        LooseParts::Refuse => {}
        LooseParts::Drop => {
            let parts = goal.drop_loose();
            let cells: usize = parts.iter().map(|part| part.cells.len()).sum();
            if cells > 0 {
                let (parts, cells) = (counted(parts.len(), "loose part"), counted(cells, "cell"));
                host.note(&format!("note: left out {parts} with {cells}\n"));
            }
        }
        LooseParts::Support => {
            let supports = goal.add_supports();
            if !supports.is_empty() {
                host.note(&format!(
                    "note: added {} to support loose parts: {}\n",
                    counted(supports.len(), "cell"),
                    listed_cells(&supports)
                ));
            }
        }
    }
}
