//! `stochc explain`.
use clap::Args;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use stochc_compiler::diagnostic::{Code, Severity};

use super::terminal::print;
use crate::exit::{Exit, Failure};
use crate::operations::codes::explain;

/// What `explain` is given.
#[derive(Debug, Args)]
pub struct ExplainArguments {
    /// Code of an error or a warning, such as `cycle`; without one, all codes are listed
    #[arg(value_parser = CodeParser, hide_possible_values = true)]
    code: Option<String>,
}

/// Prints the page of a code, or the list of all.
pub fn run(options: &ExplainArguments) -> Result<Exit, Failure> {
    let Some(name) = &options.code else {
        let lines = Code::ALL.iter().map(|code| {
            let severity = match code.severity() {
                Severity::Error => "error",
                Severity::Warning => "warning",
            };
            format!("{:20} {severity:8} {}\n", code.name(), code.meaning())
        });
        print(&lines.collect::<String>())?;
        return Ok(Exit::Success);
    };
    print(explain(name).map_err(Failure::usage)?)?;
    Ok(Exit::Success)
}

/// Takes any word, and lets a shell complete the codes.
#[derive(Clone)]
struct CodeParser;

impl TypedValueParser for CodeParser {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let codes = Code::ALL.iter();
        Some(Box::new(codes.map(|code| PossibleValue::new(code.name()))))
    }
}
