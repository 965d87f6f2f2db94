//! Settings for reading programs from their source files.
use std::path::PathBuf;

use stochc_compiler::{LintLevels, Program};
use stochc_ir::scene::scalars::{ScalarChange, find};
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
    pub set: Vec<Varied>,
}

impl SourceSettings {
    /// Returns the values that replace parameters.
    pub fn changes(&self) -> Vec<ScalarChange> {
        self.set.iter().map(change).collect()
    }

    /// Returns the set values whose parameter this program or its scene has.
    pub fn used_by(&self, program: &Program) -> Vec<Varied> {
        let is_used = |varied: &&Varied| {
            let mut own = program.plan.parameters.iter();
            let scene = program.scene.as_ref();
            own.any(|(name, _)| *name == varied.name)
                || scene.is_some_and(|scene| find(scene, &varied.name).is_ok())
        };
        self.set.iter().filter(is_used).cloned().collect()
    }
}

/// Set values that no program has used yet.
#[derive(Debug)]
pub struct UnusedValues<'a> {
    settings: &'a SourceSettings,
    unused: Vec<&'a Varied>,
    /// Parameters of all programs, for suggestions.
    parameters: Vec<String>,
}

impl<'a> UnusedValues<'a> {
    /// Creates the list before the first program is read.
    pub fn new(settings: &'a SourceSettings) -> UnusedValues<'a> {
        UnusedValues {
            settings,
            unused: settings.set.iter().collect(),
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

    /// Removes the values that a program uses. `parameters` are all parameters of the program.
    pub fn remove<'p>(&mut self, used: &[Varied], parameters: impl Iterator<Item = &'p String>) {
        self.unused.retain(|varied| !used.contains(varied));
        self.parameters.extend(parameters.cloned());
    }

    /// Removes the values that these programs use.
    pub fn remove_used_by(&mut self, programs: &[Program]) {
        for program in programs {
            let parameters = program.plan.parameters.iter();
            let used = self.settings.used_by(program);
            self.remove(&used, parameters.map(|(name, _)| name));
        }
    }

    /// Checks that a program uses each value.
    ///
    /// # Errors
    /// If no program has the parameter of a value, or a parameter has two values.
    pub fn check(mut self) -> Result<(), Failure> {
        let set = &self.settings.set;
        let is_repeated =
            |(i, it): &(usize, &Varied)| set[..*i].iter().any(|old| old.name == it.name);
        if let Some((_, twice)) = set.iter().enumerate().find(is_repeated) {
            let name = visible(&twice.name);
            return Err(Failure::usage(format!("--set: `{name}` has two values")));
        }
        let Some(first) = self.unused.first() else {
            return Ok(());
        };
        self.parameters.sort();
        self.parameters.dedup();
        let name = visible(&first.name);
        let help = match (nearest(&first.name, &self.parameters), &self.parameters[..]) {
            (Some(suggestion), _) => format!("; {}", suggestion.help()),
            (None, []) => "; the programs have no parameters of their own".to_owned(),
            (None, all) => format!("; the programs have {}", in_backticks(all)),
        };
        Err(Failure::usage(format!(
            "--set: no program or scene has a parameter `{name}`{help}"
        )))
    }
}

/// Returns the new value of a parameter.
pub fn change(varied: &Varied) -> ScalarChange {
    ScalarChange {
        name: varied.name.clone(),
        value: varied.value,
    }
}
