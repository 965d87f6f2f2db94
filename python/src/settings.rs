//! Words of the caller as settings.
use std::path::PathBuf;

use pyo3::prelude::*;
use stochc::compiler::{Level, LintLevels};
use stochc::ensemble::EnsembleProgram;
use stochc::exit::Failure;
use stochc::files::bound::folder;
use stochc::host::Host;
use stochc::operations::codes::warning;
use stochc::operations::rates;
use stochc::runtime::rates::Rates;
use stochc::runtime::{Model, Precision, Reduction, Setting, Settings, Substeps};

/// A warning and its level: `allow`, `warn` or `deny`.
pub type LevelSetting = (String, String);

/// How runs are computed, in words.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Computed {
    model: String,
    substeps: String,
    solver_iterations: Option<u32>,
    precision: String,
    reduce: Option<String>,
    max_ticks: u64,
    rates: Vec<PathBuf>,
}

/// The levels that are said, of which the last word on a code counts.
///
/// # Errors
/// If there is no such warning.
pub fn levels(said: &[LevelSetting]) -> Result<LintLevels, Failure> {
    let mut levels = LintLevels::default();
    for (code, level) in said {
        let level = match level.as_str() {
            "allow" => Level::Allow,
            "deny" => Level::Deny,
            _ => Level::Warn,
        };
        levels.set(warning(code).map_err(Failure::usage)?, level);
    }
    Ok(levels)
}

impl Computed {
    /// Returns the settings without rates, as the caller gives them.
    ///
    /// # Errors
    /// If there is no value of such a name.
    pub fn given(&self) -> Result<Settings, Failure> {
        let steps: Substeps = parsed("substeps", &self.substeps)?;
        Ok(Settings {
            model: named("model", &self.model, &Model::ALL, Model::name)?,
            solver_iterations: self.solver_iterations,
            precision: named(
                "precision",
                &self.precision,
                &Precision::ALL,
                Precision::name,
            )?,
            reduction: (self.reduce.as_ref())
                .map(|name| named("reduce", name, &Reduction::ALL, Reduction::name))
                .transpose()?,
            max_ticks: Some(self.max_ticks),
            ..Settings::default().with_steps(steps)
        })
    }

    /// Returns the rates in the files of the caller. Warns of those for other scenes.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn rates(
        &self,
        programs: &[EnsembleProgram],
        host: &dyn Host,
    ) -> Result<Vec<Rates>, Failure> {
        let scenes = programs.iter().map(|program| &program.scene);
        rates::of_files_for(&self.rates, scenes, host)
    }

    /// The settings, with the rates that the programs need.
    ///
    /// # Errors
    /// If a word is none, or there are no rates and they cannot be measured.
    pub fn settings(
        &self,
        programs: &[EnsembleProgram],
        threads: Option<u16>,
        host: &dyn Host,
    ) -> Result<Settings, Failure> {
        let settings = self.given()?;
        self.are_used(&settings)?;
        let mut settings = settings.resolved();
        if settings.model == Model::Rate {
            let given = self.rates(programs, host)?;
            settings.rates = rates::of_scenes(&given, programs, threads, host)?;
        }
        Ok(settings)
    }

    /// Refuses what is set and the model has no use for.
    fn are_used(&self, settings: &Settings) -> Result<(), Failure> {
        let model = settings.model;
        let rates = (!self.rates.is_empty()).then_some(Setting::Rates);
        let parameter = match model.unused(settings.chosen().chain(rates)) {
            None => return Ok(()),
            Some(Setting::Steps) => "substeps",
            Some(Setting::SolverIterations) => "solver_iterations",
            Some(Setting::Precision) => "precision",
            Some(Setting::Reduction) => "reduce",
            Some(Setting::Rates) => "rates",
        };
        Err(Failure::usage(format!(
            "{parameter}: the model `{}` has no use for it",
            model.name()
        )))
    }
}

/// Folders from which programs may import, in which no link is left.
///
/// # Errors
/// If one is none.
pub fn folders(imports: Vec<PathBuf>) -> Result<Vec<PathBuf>, Failure> {
    let resolved = imports.iter().map(|path| {
        let found = folder(path);
        let shown = path.display();
        found.map_err(|error| Failure::usage(format!("allow_import: `{shown}`: {error}")))
    });
    resolved.collect()
}

/// A value that is said in words.
///
/// # Errors
/// What is wrong with them.
pub fn parsed<T: std::str::FromStr<Err = String>>(what: &str, text: &str) -> Result<T, Failure> {
    (text.parse()).map_err(|reason| Failure::usage(format!("{what}: {reason}")))
}

/// One of a few values, by its name.
fn named<T: Copy>(
    what: &str,
    name: &str,
    all: &[T],
    of: impl Fn(T) -> &'static str,
) -> Result<T, Failure> {
    let found = all.iter().find(|&&it| of(it) == name);
    found.copied().ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|&it| format!("`{}`", of(it))).collect();
        Failure::usage(format!(
            "{what}: there is no `{name}`; choose {}",
            names.join(", ")
        ))
    })
}
