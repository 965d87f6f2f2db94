//! Parameters of programs and scenes that get other values than in the source.
use stochc_ir::scene::Scene;
use stochc_ir::scene::scalars::{self, ScalarError, find};
use stochc_ir::scene::schema::SchemaNumber;
use stochc_results::{EnsembleProgram, Varied};
use stochc_text::suggest::nearest;

use super::axis::{value, varied};
use super::error::RangeError;

/// A parameter of a program or of its scene.
#[derive(Clone, Copy, Debug)]
pub enum Parameter<'a> {
    /// Parameter of the assembly, with its name. Its value is an integer.
    Program(&'a str),
    /// Parameter of the scene.
    Scene(&'static SchemaNumber),
}

impl<'a> Parameter<'a> {
    /// Returns the parameter of a program or of its scene with this name. A parameter of the
    /// program hides a scene parameter.
    ///
    /// # Errors
    ///
    /// If neither the program nor the scene has the parameter.
    pub fn find(program: &EnsembleProgram, name: &'a str) -> Result<Parameter<'a>, RangeError> {
        if program.parameters.contains_key(name) {
            return Ok(Parameter::Program(name));
        }
        find(&program.scene, name)
            .map(Parameter::Scene)
            .map_err(|error| {
                let own = || program.parameters.keys().map(String::as_str);
                match (&error, nearest(name, own())) {
                    (ScalarError::Unknown { .. }, Some(suggestion)) => RangeError::NoParameter {
                        program: program.name.clone(),
                        name: name.to_owned(),
                        suggestion: suggestion.word,
                    },
                    _ => RangeError::Parameter { error },
                }
            })
    }

    /// Returns the full name of the parameter.
    pub fn name(self) -> &'a str {
        match self {
            Parameter::Program(name) => name,
            Parameter::Scene(number) => number.name(),
        }
    }

    /// Returns whether the value of the parameter is an integer.
    pub fn is_whole(self) -> bool {
        match self {
            Parameter::Program(_) => true,
            Parameter::Scene(number) => number.is_whole(),
        }
    }

    /// Returns the parameter with a value that is given in `unit`.
    ///
    /// # Errors
    ///
    /// If the parameter cannot have this value.
    pub(crate) fn with_value(self, given: f64, unit: &str) -> Result<Varied, RangeError> {
        let name = match self {
            Parameter::Program(name) => name,
            Parameter::Scene(number) => return varied(number, given, unit),
        };
        let varied = Varied {
            name: name.to_owned(),
            value: given,
            given,
            unit: unit.to_owned(),
        };
        if unit.is_empty() && given.fract() == 0.0 && given.abs() <= MAX_INTEGER {
            Ok(varied)
        } else {
            Err(RangeError::ProgramParameter {
                name: varied.name.clone(),
                value: varied.value(),
            })
        }
    }
}

/// Largest accepted value. A floating-point number stores every smaller integer exactly.
const MAX_INTEGER: f64 = 9_007_199_254_740_992.0;

/// A parameter with one value, as the user has written it: `height=8`, `bond.pull=10 N`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValue {
    /// Name of the parameter.
    pub name: String,
    /// Value in `unit`.
    given: f64,
    unit: String,
}

impl ParameterValue {
    /// Parses `NAME=VALUE`.
    ///
    /// # Errors
    ///
    /// If the form is wrong, or no parameter of this name can have the value. Does not check whether
    /// a program or scene has the parameter.
    pub fn parse(text: &str) -> Result<ParameterValue, RangeError> {
        let (name, given) = text.split_once('=').ok_or(RangeError::Value)?;
        if name.trim().is_empty() || given.contains(',') || given.contains("..") {
            return Err(RangeError::Value);
        }
        let (given, unit) = value(given)?;
        let value = ParameterValue {
            name: name.trim().to_owned(),
            given,
            unit,
        };
        let of_program = value.of(Parameter::Program(&value.name));
        if of_program.is_err() && value.of_scenes().next().is_none() {
            let mut numbers = scalars::all().filter(|it| value.names(it));
            let number = numbers.next().map(Parameter::Scene);
            number.map_or(of_program, |number| value.of(number))?;
        }
        Ok(value)
    }

    /// Returns the value of a program parameter with this name. `None` if it is not an integer.
    pub fn integer(&self) -> Option<i64> {
        let value = self.of(Parameter::Program(&self.name)).ok()?;
        Some(value.given as i64)
    }

    /// Returns the value for each scene parameter with this name that can have it. A short name can
    /// have several meanings, such as a speed and a temperature.
    pub fn of_scenes(&self) -> impl Iterator<Item = Varied> {
        let numbers = scalars::all().filter(|number| self.names(number));
        numbers.filter_map(|number| self.of(Parameter::Scene(number)).ok())
    }

    /// Returns the value for a program with these `parameters` and this scene. `None` if neither has
    /// the parameter.
    ///
    /// # Errors
    ///
    /// If the parameter cannot have this value.
    pub fn in_program<'p>(
        &self,
        mut parameters: impl Iterator<Item = &'p str>,
        scene: Option<&Scene>,
    ) -> Result<Option<Varied>, RangeError> {
        let parameter = if parameters.any(|name| name == self.name) {
            Some(Parameter::Program(&self.name))
        } else {
            let number = scene.and_then(|scene| find(scene, &self.name).ok());
            number.map(Parameter::Scene)
        };
        parameter.map(|parameter| self.of(parameter)).transpose()
    }

    fn of(&self, parameter: Parameter<'_>) -> Result<Varied, RangeError> {
        parameter.with_value(self.given, &self.unit)
    }

    fn names(&self, number: &SchemaNumber) -> bool {
        number.names.contains(&&*self.name)
    }
}
