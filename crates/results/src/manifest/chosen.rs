//! Settings that a sweep varies, such as `--vary substeps=1,2,4`.
use serde::{Deserialize, Serialize};
use stochc_ir::scene::InvalidSubsteps;
use stochc_runtime::{Model, Precision, Reduction, Settings, Substeps};
use thiserror::Error;

/// Names of the settings that a sweep may vary. They are options of `simulate`.
const NAMES: [&str; 5] = [
    "model",
    "substeps",
    "solver-iterations",
    "precision",
    "without",
];

/// Value of the setting `without` that leaves out no term.
const NOTHING: &str = "none";

const MAX_ITERATIONS: u32 = 1000;

/// Error of choosing a setting.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum InvalidSetting {
    /// No setting that a sweep can vary has this name.
    #[error("a sweep has no setting `{0}`")]
    Name(String),
    /// The steps are invalid.
    #[error("`{choice}`: {reason}")]
    Substeps {
        /// Setting with the rejected value, such as `substeps=0`.
        choice: String,
        /// Reason why the steps are invalid.
        reason: InvalidSubsteps,
    },
    /// The number of solver iterations is invalid.
    #[error("`{0}`: give a number from 1 to {MAX_ITERATIONS}")]
    Iterations(String),
    /// The setting has no value of this name.
    #[error("`{choice}`: give one of {names}")]
    Value {
        /// Setting with the rejected value.
        choice: String,
        /// List of the names of all valid values.
        names: String,
    },
}

/// Setting that a sweep has selected for a point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChosenSetting {
    /// Option of `simulate`, such as `substeps`.
    name: String,
    /// Value, such as `2/8`.
    value: String,
}

impl ChosenSetting {
    /// Returns whether a sweep may vary a setting of this name.
    pub fn is_name(name: &str) -> bool {
        NAMES.contains(&name)
    }

    /// Chooses a value for a setting.
    ///
    /// # Errors
    /// If the setting cannot have the value.
    pub fn new(name: &str, value: &str) -> Result<ChosenSetting, InvalidSetting> {
        let chosen = ChosenSetting {
            name: name.to_owned(),
            value: value.to_owned(),
        };
        chosen.apply(&mut Settings::default()).map(|()| chosen)
    }

    /// Returns the settings as choices, the model first. Omits defaults, except for the steps.
    pub fn all_of(settings: &Settings) -> Vec<ChosenSetting> {
        let model = settings.model;
        let steps = model.has_places().then(|| settings.steps().to_string());
        let iterations = settings.solver_iterations.map(|it| it.to_string());
        let is_double = settings.precision != Precision::default();
        let precision = is_double.then(|| settings.precision.name().to_owned());
        let reduction = settings.reduction.map(|it| it.name().to_owned());
        let values = [
            Some(model.name().to_owned()),
            steps,
            iterations,
            precision,
            reduction,
        ];
        let values = NAMES.into_iter().zip(values);
        let chosen = |(name, value): (&str, Option<String>)| {
            value.map(|value| ChosenSetting {
                name: name.to_owned(),
                value,
            })
        };
        values.filter_map(chosen).collect()
    }

    /// Returns the position of the setting's name in the order of [`ChosenSetting::all_of`].
    pub fn index(&self) -> usize {
        let index = NAMES.iter().position(|it| *it == self.name);
        index.unwrap_or(NAMES.len())
    }

    /// Returns the name of the setting, such as `substeps`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the value of the setting, such as `2/8`.
    pub fn value(&self) -> &str {
        &self.value
    }

    /// Returns name and value, such as `substeps=2/8`.
    pub fn text(&self) -> String {
        format!("{}={}", self.name, self.value)
    }

    /// Changes settings to the chosen value.
    ///
    /// # Errors
    /// If the setting cannot have the value.
    pub(super) fn apply(&self, settings: &mut Settings) -> Result<(), InvalidSetting> {
        match &*self.name {
            "model" => settings.model = self.named(&Model::ALL, Model::name)?,
            "substeps" => {
                let steps: Substeps =
                    (self.value.parse()).map_err(|reason| InvalidSetting::Substeps {
                        choice: self.text(),
                        reason,
                    })?;
                (settings.substeps, settings.away) = (steps.near, steps.away);
            }
            "solver-iterations" => {
                let iterations = self.value.parse().ok();
                let iterations = iterations.filter(|it| (1..=MAX_ITERATIONS).contains(it));
                let iterations =
                    iterations.ok_or_else(|| InvalidSetting::Iterations(self.text()))?;
                settings.solver_iterations = Some(iterations);
            }
            "precision" => settings.precision = self.named(&Precision::ALL, Precision::name)?,
            "without" if self.value == NOTHING => settings.reduction = None,
            "without" => settings.reduction = Some(self.named(&Reduction::ALL, Reduction::name)?),
            other => return Err(InvalidSetting::Name(other.to_owned())),
        }
        Ok(())
    }

    /// Returns the element of `all` that has the chosen value as its name.
    fn named<T: Copy>(&self, all: &[T], name: fn(T) -> &'static str) -> Result<T, InvalidSetting> {
        let found = all.iter().find(|&&it| name(it) == self.value);
        found.copied().ok_or_else(|| {
            let names: Vec<String> = all.iter().map(|&it| format!("`{}`", name(it))).collect();
            InvalidSetting::Value {
                choice: self.text(),
                names: names.join(", "),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_change_settings_and_survive_a_round_trip() {
        let written = [
            ("model", "rigid"),
            ("substeps", "2/8"),
            ("solver-iterations", "30"),
            ("precision", "double"),
            ("without", "corners"),
        ];
        let chosen = written.map(|(name, value)| ChosenSetting::new(name, value).unwrap());
        let mut settings = Settings::new(Model::Rapier, 1);
        for choice in &chosen {
            choice.apply(&mut settings).unwrap();
        }
        let expected = Settings {
            solver_iterations: Some(30),
            precision: Precision::Double,
            reduction: Some(Reduction::Corners),
            ..Settings::default()
        };
        assert_eq!(settings, expected);
        assert_eq!(ChosenSetting::all_of(&settings), chosen);
        let nothing = ChosenSetting::new("without", "none").unwrap();
        nothing.apply(&mut settings).unwrap();
        assert_eq!(settings.reduction, None);
    }

    #[test]
    fn values_that_a_setting_cannot_have_are_rejected() {
        for (name, value, reason) in [
            ("model", "rigit", "give one of `rigid`, `rapier`, `rate`"),
            ("substeps", "3/8", "say from 1 to"),
            ("solver-iterations", "0", "a number from 1 to 1000"),
            ("precision", "half", "`single`, `double`"),
            ("without", "gravity", "`rotation`"),
            ("threads", "2", "no setting `threads`"),
        ] {
            let message = ChosenSetting::new(name, value).unwrap_err().to_string();
            assert!(message.contains(reason), "{message}");
        }
    }
}
