//! Conversion of Python arguments to settings.
use std::path::PathBuf;

use pyo3::prelude::*;
use stochc::SourceSettings;
use stochc::compiler::{Level, LintLevels};
use stochc::exit::Failure;
use stochc::experiments::sweep::ParameterValue;
use stochc::files::bound::folder;
use stochc::host::Host;
use stochc::operations::codes::warning;
use stochc::operations::rates;
use stochc::results::EnsembleProgram;
use stochc::runtime::rates::Rates;
use stochc::runtime::{Model, Precision, Reduction, Setting, Settings, Substeps};

/// Name of a warning, and its level: `allow`, `warn` or `deny`.
pub type LevelSetting = (String, String);

/// Python arguments for the settings of runs.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub struct Computed {
    model: String,
    substeps: String,
    solver_iterations: Option<u32>,
    precision: String,
    without: Option<String>,
    max_ticks: u64,
    rates: Vec<PathBuf>,
}

/// Returns the levels of warnings. The last level of a code takes precedence.
///
/// # Errors
///
/// If no warning has this code.
pub fn levels(settings: &[LevelSetting]) -> Result<LintLevels, Failure> {
    let mut levels = LintLevels::default();
    for (code, level) in settings {
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
    /// Returns the settings that the arguments determine, without rates.
    ///
    /// # Errors
    ///
    /// If the name of a value is unknown.
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
            reduction: (self.without.as_ref())
                .map(|name| named("without", name, &Reduction::ALL, Reduction::name))
                .transpose()?,
            max_ticks: Some(self.max_ticks),
            ..Settings::default().with_steps(steps)
        })
    }

    /// Reads the caller's files of rates. Warns about rates for other scenes.
    ///
    /// # Errors
    ///
    /// If a file cannot be read.
    pub fn rates(
        &self,
        programs: &[EnsembleProgram],
        host: &dyn Host,
    ) -> Result<Vec<Rates>, Failure> {
        let scenes = programs.iter().map(|program| &program.scene);
        rates::read_rates_for(&self.rates, scenes, host)
    }

    /// Returns the settings, with the rates that the programs need.
    ///
    /// # Errors
    ///
    /// If the name of a value is unknown, or rates are missing and cannot be calibrated.
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
            settings.rates = rates::rates_for_scenes(&given, programs, threads, host)?;
        }
        Ok(settings)
    }

    /// Checks that the model uses all settings that are given.
    fn are_used(&self, settings: &Settings) -> Result<(), Failure> {
        let model = settings.model;
        let rates = (!self.rates.is_empty()).then_some(Setting::Rates);
        let parameter = match model.unused(settings.chosen().chain(rates)) {
            None => return Ok(()),
            Some(Setting::Steps) => "substeps",
            Some(Setting::SolverIterations) => "solver_iterations",
            Some(Setting::Precision) => "precision",
            Some(Setting::Reduction) => "without",
            Some(Setting::Rates) => "rates",
        };
        Err(Failure::usage(format!(
            "{parameter}: not used by the model `{}`",
            model.name()
        )))
    }
}

/// Returns the settings for reading programs. `set` contains texts of the form `NAME=VALUE`.
///
/// # Errors
///
/// If a code, folder or value is invalid.
pub fn source_settings(
    level_settings: &[LevelSetting],
    imports: Vec<PathBuf>,
    set: &[String],
) -> Result<SourceSettings, Failure> {
    let value = |text: &String| {
        let value = ParameterValue::parse(text);
        value.map_err(|error| Failure::usage(format!("`{text}`: {error}")))
    };
    Ok(SourceSettings {
        levels: levels(level_settings)?,
        imports: folders(imports)?,
        set: set.iter().map(value).collect::<Result<_, _>>()?,
    })
}

/// Returns the folders for imports, with all links resolved.
///
/// # Errors
///
/// If a path is not a folder.
pub fn folders(imports: Vec<PathBuf>) -> Result<Vec<PathBuf>, Failure> {
    let resolved = imports.iter().map(|path| {
        let found = folder(path);
        let shown = path.display();
        found.map_err(|error| Failure::usage(format!("allow_import: `{shown}`: {error}")))
    });
    resolved.collect()
}

/// Parses the value of an argument.
///
/// # Errors
///
/// The message of the parser.
pub fn parsed<T: std::str::FromStr<Err: std::fmt::Display>>(
    what: &str,
    text: &str,
) -> Result<T, Failure> {
    (text.parse()).map_err(|reason| Failure::usage(format!("{what}: {reason}")))
}

/// Returns the element of `all` with this name. `what` is the name of the argument in error
/// messages.
pub(super) fn named<T: Copy>(
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
