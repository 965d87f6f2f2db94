//! Options for reading programs: levels of warnings, imports and parameters.
use clap::Args;
use stochc_experiments::sweep::ParameterValue;

use super::imports::ImportOptions;
use super::levels::LevelOptions;
use crate::SourceSettings;

/// Options for reading the source files of programs.
#[derive(Clone, Debug, Default, Args)]
pub struct SourceOptions {
    #[command(flatten)]
    pub levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
    /// Set a parameter of the programs or of their scenes, such as `height=8` or `bond.pull=10N`
    #[arg(long, value_name = "NAME=VALUE", value_parser = value, help_heading = "Parameters")]
    set: Vec<ParameterValue>,
}

impl SourceOptions {
    /// Returns the settings for reading programs.
    pub fn settings(&self) -> SourceSettings {
        SourceSettings {
            levels: self.levels.levels.clone(),
            imports: self.imports.folders.clone(),
            set: self.set.clone(),
        }
    }
}

fn value(text: &str) -> Result<ParameterValue, String> {
    ParameterValue::parse(text).map_err(|error| error.to_string())
}
