//! The options `--allow`, `--warn` and `--deny`, in the order of the command line.
use std::ffi::OsStr;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches};
use stochc_compiler::diagnostic::{Code, Severity};
use stochc_compiler::{Level, LintLevels};

use crate::operations::codes::{ALL_WARNINGS, warning};

/// Levels of warnings from the command line. The last option for a code takes precedence.
#[derive(Clone, Debug, Default)]
pub struct LevelOptions {
    /// Levels from the command line, for warnings whose level the source does not set.
    pub levels: LintLevels,
}

/// Options with the level and the help text of each.
const OPTIONS: [(&str, Level, &str); 3] = [
    (
        "allow",
        Level::Allow,
        "Do not report warnings with this code. `warnings` stands for all codes. `stochc explain` lists the codes",
    ),
    (
        "warn",
        Level::Warn,
        "Report warnings with this code [default]",
    ),
    (
        "deny",
        Level::Deny,
        "Report warnings with this code as errors. An `allow` or `deny` in the file takes precedence",
    ),
];

impl Args for LevelOptions {
    fn augment_args(command: Command) -> Command {
        let command = command.next_help_heading("Warnings and imports");
        command.args(OPTIONS.map(|(name, _, help)| {
            Arg::new(name)
                .long(name)
                .value_name("CODE")
                .help(help)
                .action(ArgAction::Append)
                .value_delimiter(',')
                .hide_possible_values(true)
                .value_parser(Warnings)
        }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        LevelOptions::augment_args(command)
    }
}

impl FromArgMatches for LevelOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<LevelOptions, Error> {
        let mut given = Vec::new();
        for (name, level, _) in OPTIONS {
            let codes = matches.get_many::<Warning>(name).into_iter().flatten();
            let places = matches.indices_of(name).into_iter().flatten();
            given.extend(places.zip(codes).map(|(place, code)| (place, *code, level)));
        }
        given.sort_by_key(|(place, ..)| *place);
        let mut levels = LintLevels::default();
        for (_, Warning(code), level) in given {
            levels.set(code, level);
        }
        Ok(LevelOptions { levels })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = LevelOptions::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Warning that an option names. `None` means all warnings.
#[derive(Clone, Copy, Debug)]
struct Warning(Option<Code>);

/// Parser for warnings by their code.
#[derive(Clone)]
struct Warnings;

impl TypedValueParser for Warnings {
    type Value = Warning;

    fn parse_ref(
        &self,
        command: &Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<Warning, Error> {
        let reason = match warning(&value.to_string_lossy()) {
            Ok(code) => return Ok(Warning(code)),
            Err(reason) => reason,
        };
        let option =
            argument.map_or_else(String::new, |argument| format!("--{}: ", argument.get_id()));
        let error = Error::raw(ErrorKind::InvalidValue, format!("{option}{reason}\n"));
        Err(error.with_cmd(command))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let codes = Code::ALL.iter();
        let warnings = codes.filter(|code| code.severity() == Severity::Warning);
        let names = std::iter::once(ALL_WARNINGS).chain(warnings.map(|code| code.name()));
        Some(Box::new(names.map(PossibleValue::new)))
    }
}
