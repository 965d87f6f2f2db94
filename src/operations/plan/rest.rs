//! Planning of a rest: of an incomplete run, or of a partial program.
use std::collections::BTreeSet;
use std::path::Path;

use stochc_results::EnsembleProgram;

use super::super::chosen_run::choose;
use super::super::programs::verdict;
use super::super::results::read;
use super::super::stored_source::StoredSource;
use super::goal::placed;
use super::not_planned::NotPlanned;
use super::not_planned::refused;
use super::options::{PlanOptions, RunEnd};
use super::target;
use crate::exit::Failure;
use crate::host::Host;
use stochc_planner::{Completion, ExistingStructure, Goal, NotCompleted};

/// Returns the captures that are missing in a program.
///
/// # Errors
/// If the program cannot be read, has errors, or is complete.
pub fn completion(options: &PlanOptions<'_>, host: &dyn Host) -> Result<Completion, NotPlanned> {
    if target::is_of_voxels(options.target) {
        let wrong = "`--complete` is for programs: a file of voxels is one shape";
        return Err(Failure::usage(wrong).into());
    }
    let checked = target::checked(options)?;
    Completion::new(&checked, options.shape).map_err(|error| match error {
        NotCompleted::Wrong => {
            host.report_diagnostics(&checked);
            Failure::silent(verdict(&checked)).into()
        }
        NotCompleted::Refused(reason) => refused(options.target, reason).into(),
        NotCompleted::Impossible(error) => NotPlanned::impossible(options, error),
    })
}

/// Returns the blocks that are missing at the end of a stored run.
///
/// # Errors
/// If the run does not exist, its program is not stored, or nothing is missing.
pub fn goal(options: &PlanOptions<'_>, end: &RunEnd<'_>, host: &dyn Host) -> Result<Goal, Failure> {
    let folder = Path::new(options.target);
    let (manifest, finished) = read(folder, host)?;
    let chosen = choose(manifest, &finished, Some(folder), end.program, end.run)?;
    let record = chosen.known().ok_or_else(|| {
        Failure::usage(format!(
            "run {} of `{}` is not finished",
            end.run, options.target
        ))
    })?;
    let entry = chosen.entry();
    refuse_aggregate(entry)?;
    let structure = ExistingStructure::from_record(entry.tables(), record);
    let dead: BTreeSet<&str> = end.dead.iter().map(String::as_str).collect();
    if let Some(unknown) = dead
        .iter()
        .find(|name| structure.names().all(|known| known != **name))
    {
        let tables = entry.tables();
        if (tables.seeds()).any(|(role, _)| tables.name(role) == *unknown) {
            return Err(Failure::usage(format!(
                "`{unknown}` is a block of the plate: only captured ones can be dead; leave it out of the program's plate, and plan its shape with `--plate`, where a block of the plate has failed"
            )));
        }
        let known: Vec<String> = structure.names().map(|name| format!("`{name}`")).collect();
        return Err(Failure::usage(format!(
            "no block is called `{unknown}` at the end of the run; there are {}",
            if known.is_empty() {
                "none".to_owned()
            } else {
                known.join(", ")
            }
        )));
    }
    let text = StoredSource::as_written(entry);
    let program = text.same_program().ok_or_else(|| {
        Failure::usage(format!(
            "`{}` does not hold the text of the program, or this version compiles it otherwise",
            options.target
        ))
    })?;
    if options.scene.is_none() && program.scene.as_ref() != Some(&entry.scene) {
        return Err(Failure::usage(
            "numbers of the scene were varied in these runs: name the scene to plan for with `--scene`",
        ));
    }
    let mut goal = Goal::from_end(&text.checked, program, options.shape)
        .map_err(|error| refused(options.target, error))?;
    (goal.stand_on(&structure, &dead)).map_err(|error| refused(options.target, error))?;
    placed(goal, options, host)
}

/// Checks that a program can be planned.
///
/// # Errors
/// If the program is an aggregate.
fn refuse_aggregate(program: &EnsembleProgram) -> Result<(), Failure> {
    match program.tables().aggregate {
        None => Ok(()),
        Some(_) => Err(Failure::usage(format!(
            "`{}` is an aggregate: it grows at random and cannot be planned",
            program.name
        ))),
    }
}
