//! Parameters of programs and scenes with values that replace those in the source.
use serde::{Deserialize, Serialize};

/// Parameter of a program or scene, with a value that replaces the one in the source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Varied {
    /// Name of the parameter, such as `height` or `bond.pull`.
    pub name: String,
    /// Value in SI units.
    pub value: f64,
    /// Value in `unit`, as the user wrote it.
    pub given: f64,
    /// Unit as the user wrote it. Empty if the value has no unit.
    pub unit: String,
}

/// Axes of a sweep.
#[derive(Clone, Debug, Default)]
pub struct SweepAxes<'a> {
    /// Parameters that the sweep varies.
    pub numbers: &'a [Varied],
    /// Names of the settings that the sweep varies.
    pub settings: Vec<&'a str>,
}

impl Varied {
    /// Returns the value as the user wrote it, such as `4.5 N`.
    pub fn value(&self) -> String {
        match &*self.unit {
            "" => self.given.to_string(),
            unit => format!("{} {unit}", self.given),
        }
    }

    /// Returns the name and value of the parameter, such as `bond.pull=4.5 N`.
    pub fn text(&self) -> String {
        format!("{}={}", self.name, self.value())
    }

    /// Returns the name of the parameter's column in tables, such as `scene_bond_pull`.
    pub fn column(&self) -> String {
        format!("scene_{}", self.name.replace('.', "_"))
    }
}
