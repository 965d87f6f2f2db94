//! Settings for reading programs from their source files.
use std::path::PathBuf;

use stochc_compiler::{LintLevels, ParameterChange, Program};
use stochc_experiments::sweep::{ParameterValue, RangeError};
use stochc_ir::scene::Scene;
use stochc_ir::scene::scalars::{self, ScalarChange};
use stochc_results::Varied;
use stochc_text::suggest::nearest;
use stochc_text::{in_backticks, visible};

use crate::exit::Failure;

/// Settings for reading and checking the source files of programs.
#[derive(Clone, Debug, Default)]
pub struct SourceSettings {
    /// Levels of warnings whose level the source does not set.
    pub levels: LintLevels,
    /// Folders that imports may come from, in addition to the folder of the program.
    pub imports: Vec<PathBuf>,
    /// Values that replace parameters of programs and scenes.
    pub set: Vec<ParameterValue>,
}

impl SourceSettings {
    /// Returns the values that replace parameters.
    pub fn changes(&self) -> Vec<ParameterChange> {
        let change = |value: &ParameterValue| ParameterChange {
            name: value.name.clone(),
            integer: value.integer(),
            scene: value.of_scenes().map(|it| scene_change(&it)).collect(),
        };
        self.set.iter().map(change).collect()
    }

    /// Returns the set values whose parameter this program or its scene has.
    ///
    /// # Errors
    /// If a parameter cannot have its value.
    pub fn used_by(&self, program: &Program) -> Result<Vec<Varied>, Failure> {
        let in_program = |value: &ParameterValue| {
            let parameters = program.plan.parameters.iter().map(|(name, _)| &**name);
            value.in_program(parameters, program.scene.as_ref())
        };
        let used = self.set.iter().filter_map(|it| in_program(it).transpose());
        used.collect::<Result<_, _>>().map_err(not_allowed)
    }
}

fn not_allowed(error: RangeError) -> Failure {
    Failure::usage(format!("--set: {error}"))
}

/// Set values that no program has used yet.
#[derive(Debug)]
pub struct UnusedValues<'a> {
    settings: &'a SourceSettings,
    unused: Vec<&'a ParameterValue>,
    /// First value that its parameter cannot have.
    invalid: Option<RangeError>,
    /// Parameters of all programs, for suggestions.
    parameters: Vec<String>,
}

impl<'a> UnusedValues<'a> {
    /// Creates the list before the first program is read.
    pub fn new(settings: &'a SourceSettings) -> UnusedValues<'a> {
        UnusedValues {
            settings,
            unused: settings.set.iter().collect(),
            invalid: None,
            parameters: Vec::new(),
        }
    }

    /// Checks that these programs use all values.
    ///
    /// # Errors
    /// If no program has the parameter of a value.
    pub fn check_used_by(settings: &SourceSettings, programs: &[Program]) -> Result<(), Failure> {
        let mut unused = UnusedValues::new(settings);
        unused.remove_used_by(programs);
        unused.check()
    }

    /// Returns the settings that contain the values.
    pub fn settings(&self) -> &'a SourceSettings {
        self.settings
    }

    /// Removes the values that a program with these `parameters` and this scene uses.
    pub fn remove<'p>(
        &mut self,
        parameters: impl Iterator<Item = &'p str> + Clone,
        scene: Option<&Scene>,
    ) {
        for value in &self.settings.set {
            match value.in_program(parameters.clone(), scene) {
                Ok(None) => continue,
                Ok(Some(_)) => {}
                Err(error) => {
                    self.invalid.get_or_insert(error);
                }
            }
            self.unused.retain(|unused| *unused != value);
        }
        self.parameters.extend(parameters.map(str::to_owned));
    }

    /// Removes the values that these programs use.
    pub fn remove_used_by(&mut self, programs: &[Program]) {
        for program in programs {
            let parameters = program.plan.parameters.iter().map(|(name, _)| &**name);
            self.remove(parameters, program.scene.as_ref());
        }
    }

    /// Checks that a program uses each value.
    ///
    /// # Errors
    /// If no program has the parameter of a value, or a parameter has two values or cannot have its
    /// value.
    pub fn check(mut self) -> Result<(), Failure> {
        let set = &self.settings.set;
        let is_repeated =
            |(i, it): &(usize, &ParameterValue)| set[..*i].iter().any(|old| old.name == it.name);
        if let Some((_, twice)) = set.iter().enumerate().find(is_repeated) {
            let name = visible(&twice.name);
            return Err(Failure::usage(format!("--set: `{name}` has two values")));
        }
        if let Some(error) = self.invalid {
            return Err(not_allowed(error));
        }
        let Some(first) = self.unused.first() else {
            return Ok(());
        };
        self.parameters.sort();
        self.parameters.dedup();
        let name = visible(&first.name);
        let known = || scalars::all().flat_map(|number| number.names).copied();
        let elsewhere = scalars::all().find(|number| number.names.contains(&&*first.name));
        let suggestion = nearest(&first.name, &self.parameters);
        let suggestion = suggestion.or_else(|| nearest(&first.name, known()));
        let help = match (elsewhere, suggestion, &self.parameters[..]) {
            (Some(number), ..) => format!(
                "; write the clause `{}` with this parameter in a scene",
                number.clause()
            ),
            (None, Some(suggestion), _) => format!("; {}", suggestion.help()),
            (None, None, []) => "; the programs have no parameters of their own".to_owned(),
            (None, None, all) => format!("; the programs have {}", in_backticks(all)),
        };
        Err(Failure::usage(format!(
            "--set: no program or scene has a parameter `{name}`{help}"
        )))
    }
}

/// Returns the new value of a parameter of one program.
pub fn change(varied: &Varied) -> ParameterChange {
    ParameterChange {
        name: varied.name.clone(),
        integer: Some(varied.value as i64),
        scene: vec![scene_change(varied)],
    }
}

fn scene_change(varied: &Varied) -> ScalarChange {
    ScalarChange {
        name: varied.name.clone(),
        value: varied.value,
    }
}
