//! Presentation of programs and times.
use std::str::FromStr;

use stochc_experiments::TimeUnit;
use stochc_results::EnsembleProgram;

/// Label of a program: a name, and the text to show instead of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramLabel {
    /// Name of the program in the ensemble, without the values of a sweep.
    pub name: String,
    /// Label to show instead of the name.
    pub text: String,
}

/// Names of programs and unit of times in tables and figures.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Presentation {
    /// Whether all times are in seconds. If `false`, times are in ticks, or in seconds if the tick
    /// lengths of programs differ.
    pub in_seconds: bool,
    /// Labels that the user gave to programs.
    pub labels: Vec<ProgramLabel>,
}

/// Error of parsing a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("give NAME=TEXT, such as `tower=Tower of five`")]
pub struct InvalidLabel;

impl FromStr for ProgramLabel {
    type Err = InvalidLabel;

    fn from_str(label: &str) -> Result<ProgramLabel, InvalidLabel> {
        let (name, text) = label.split_once('=').ok_or(InvalidLabel)?;
        Ok(ProgramLabel {
            name: name.to_owned(),
            text: text.to_owned(),
        })
    }
}

impl ProgramLabel {
    /// Returns whether `name` is the name of the labelled program or of a point of its sweep.
    pub fn is_of(&self, name: &str) -> bool {
        let values = name.strip_prefix(&*self.name);
        values.is_some_and(|values| values.is_empty() || values.starts_with(" ["))
    }
}

impl Presentation {
    /// Returns the text to show for a program or a point of its sweep. Without a label, returns its
    /// name.
    pub fn label(&self, name: &str) -> String {
        let label = self.labels.iter().find(|label| label.is_of(name));
        label.map_or(name.to_owned(), |label| {
            format!("{}{}", label.text, &name[label.name.len()..])
        })
    }

    /// Returns the first label whose name belongs to none of these programs.
    pub fn unused<'a>(
        &self,
        programs: impl Iterator<Item = &'a EnsembleProgram> + Clone,
    ) -> Option<&ProgramLabel> {
        let is_used = |label: &ProgramLabel| programs.clone().any(|it| label.is_of(&it.name));
        self.labels.iter().find(|label| !is_used(label))
    }

    /// Returns the unit for comparing the times of programs.
    pub fn unit<'a>(&self, programs: impl Iterator<Item = &'a EnsembleProgram>) -> TimeUnit {
        if self.in_seconds {
            TimeUnit::Seconds
        } else {
            TimeUnit::common(programs)
        }
    }
}
