//! The option `--set`.
use clap::Args;
use stochc_experiments::sweep::ParameterValue;
use stochc_results::Varied;

use super::imports::ImportOptions;
use super::levels::LevelOptions;
use crate::SourceSettings;

/// Values of parameters.
#[derive(Clone, Debug, Default, Args)]
pub struct ParameterOptions {
    /// Set a parameter of the programs or of their scenes, such as `height=8` or `bond.pull=10N`
    #[arg(long, value_name = "NAME=VALUE", value_parser = value, help_heading = "Parameters")]
    set: Vec<Varied>,
}

impl ParameterOptions {
    /// Returns the settings for reading programs.
    pub fn settings(&self, levels: &LevelOptions, imports: &ImportOptions) -> SourceSettings {
        SourceSettings {
            levels: levels.levels.clone(),
            imports: imports.folders.clone(),
            set: self.set.clone(),
        }
    }
}

fn value(text: &str) -> Result<Varied, String> {
    let parsed = ParameterValue::parse(text).and_then(|value| value.for_any());
    parsed.map_err(|error| error.to_string())
}
