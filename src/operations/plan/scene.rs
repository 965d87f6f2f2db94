//! Scene of a plan: the scene that an option names, the only scene of a file, or the default. Adds
//! free blocks if needed.
use std::path::Path;

use stochc_compiler::scene::{DEFAULT, built_in_names};
use stochc_ir::scene::room::NoRoom;
use stochc_text::{in_backticks, visible};

use super::super::programs::verdict;
use super::{PlanOptions, PlanScope, target};
use crate::exit::Failure;
use crate::host::Host;
use stochc_planner::Goal;

/// Sets the scene of a goal as the options require.
///
/// # Errors
/// If the scene does not exist.
pub fn choose(goal: &mut Goal, options: &PlanOptions<'_>, host: &dyn Host) -> Result<(), Failure> {
    match options.scene.map(SceneName::parse) {
        None => {}
        Some(SceneName::InFile { file, name }) => take(goal, file, name, options, host)?,
        Some(SceneName::Known(name)) => goal.scene = Some(known(goal, name)?),
    }
    Ok(())
}

/// Sets the number of free blocks as the options require. Enlarges the default scene if needed.
///
/// # Errors
/// If the scene has no room for the free blocks.
pub fn enlarge(goal: &mut Goal, options: &PlanOptions<'_>, host: &dyn Host) -> Result<(), Failure> {
    let larger = match (options.free, options.extent) {
        (Some(free), _) => goal.set_free(free),
        (None, PlanScope::Whole) => goal.enlarge_default_scene(),
        (None, _) => Ok(None),
    };
    if let Some(larger) = larger.map_err(no_room)? {
        host.note(&format!("note: {}\n", larger.in_words()));
    }
    Ok(())
}

/// Selects the scene that the target program declares, if there is only one. Does nothing if an
/// option or an assembly already determines the scene. Reports the selection.
pub fn choose_declared(goal: &mut Goal, options: &PlanOptions<'_>, host: &dyn Host) {
    // A plate comes from an assembly, whose scene is already selected.
    if options.scene.is_some() || goal.plate.is_some() {
        return;
    }
    let names: Vec<String> = goal.declared_scenes().map(str::to_owned).collect();
    let file = visible(options.target);
    match &names[..] {
        [] => {}
        [only] => {
            host.note(&format!(
                "note: planned in `{only}`, the only scene of `{file}`\n"
            ));
            goal.scene = Some(only.clone());
        }
        several => host.note(&format!(
            "note: planned in `{DEFAULT}`; `{file}` declares {}: choose one with `--scene`\n",
            in_backticks(several)
        )),
    }
}

/// Value of the option `--scene`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SceneName<'a> {
    /// Scene of a file: `lab.sa:tank`, or `lab.sa` if the file has only one scene.
    InFile {
        file: &'a str,
        name: Option<&'a str>,
    },
    /// Built-in scene, or scene that the file of the shape declares.
    Known(&'a str),
}

impl SceneName<'_> {
    fn parse(text: &str) -> SceneName<'_> {
        match text.rsplit_once(':') {
            Some((file, name)) if target::is_named_as_program(file) => SceneName::InFile {
                file,
                name: Some(name),
            },
            _ if target::is_named_as_program(text) => SceneName::InFile {
                file: text,
                name: None,
            },
            _ => SceneName::Known(text),
        }
    }
}

fn known(goal: &Goal, name: &str) -> Result<String, Failure> {
    if goal.knows_scene(name) {
        return Ok(name.to_owned());
    }
    Err(Failure::usage(format!(
        "--scene: no scene is called `{}`; {} are built in, and `--scene FILE.sa:NAME` names a scene of a file",
        visible(name),
        built_in_names()
    )))
}

/// Sets the scene of a goal to a scene of another file.
fn take(
    goal: &mut Goal,
    file: &str,
    name: Option<&str>,
    options: &PlanOptions<'_>,
    host: &dyn Host,
) -> Result<(), Failure> {
    if Path::new(file).is_dir() {
        return Err(Failure::usage(format!("--scene: `{file}` is a folder")));
    }
    let checked = target::checked_file(file, options.imports)?;
    if checked.has_errors() {
        host.report_diagnostics(&checked);
        return Err(Failure::silent(verdict(&checked)));
    }
    goal.take_scene(&checked, name).map_err(|names| {
        let declared = match names.len() {
            0 => "it declares none".to_owned(),
            _ => format!("it declares {}", in_backticks(&names)),
        };
        let missing = match name {
            Some(name) => format!("`{file}` has no scene `{}`", visible(name)),
            None => format!("`{file}` does not have exactly one scene"),
        };
        Failure::usage(format!("--scene: {missing}; {declared}"))
    })
}

fn no_room(reason: NoRoom) -> Failure {
    Failure::usage(format!("the scene cannot have more blocks: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_of_files_are_named_with_the_file() {
        let in_file = |file, name| SceneName::InFile { file, name };
        assert_eq!(
            SceneName::parse("lab.sa:tank"),
            in_file("lab.sa", Some("tank"))
        );
        assert_eq!(SceneName::parse("C:\\lab.sa"), in_file("C:\\lab.sa", None));
        assert_eq!(SceneName::parse("tank"), SceneName::Known("tank"));
        assert_eq!(SceneName::parse("lab:tank"), SceneName::Known("lab:tank"));
    }
}
