//! Scene parameters that a sweep varies.
use serde::{Deserialize, Serialize};

/// Scene parameter changed by a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Varied {
    /// Name, such as `bond.pull`.
    pub of: String,
    /// Value in SI units.
    pub value: f64,
    /// Value in `unit`, as given by the user.
    pub said: f64,
    /// Unit as given by the user. Empty without unit.
    pub unit: String,
}

/// Axes of a sweep.
#[derive(Clone, Debug, Default)]
pub struct SweepAxes<'a> {
    /// Scene parameters that the sweep varies.
    pub numbers: &'a [Varied],
    /// Names of the settings that the sweep varies.
    pub settings: Vec<&'a str>,
}

impl Varied {
    /// Returns the value as given by the user, such as `4.5 N`.
    pub fn value(&self) -> String {
        match &*self.unit {
            "" => self.said.to_string(),
            unit => format!("{} {unit}", self.said),
        }
    }

    /// Returns name and value, such as `bond.pull=4.5 N`.
    pub fn text(&self) -> String {
        format!("{}={}", self.of, self.value())
    }

    /// Returns the name of its column in tables, such as `scene_bond_pull`.
    pub fn column(&self) -> String {
        format!("scene_{}", self.of.replace('.', "_"))
    }
}
