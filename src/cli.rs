//! The command line.
use std::ffi::OsString;
use std::num::{IntErrorKind, ParseIntError};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use stochc_text::{is_invisible, visible};

use crate::command::interrupt::outlive_file_limit;
pub use crate::command::terminal::show_deferred;
use crate::command::terminal::{Color, TerminalOptions, configure, output_has_colour, print_drawn};
use crate::command::{
    calibrate, check, compile, completions, estimate, explain, export, fit, fmt, fsck, lsp, man,
    plan, repeat, replay, report, resume, shard, show, simulate, sweep, trace, trade, verify,
};
use crate::exit::{Exit, Failure};

/// Compiler, verifier and simulator for stochastic modular robots.
#[derive(Debug, Parser)]
#[command(version, about, after_help = AFTER_HELP)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print no progress, notes or warnings
    #[arg(long, short, global = true, help_heading = "Global options")]
    pub quiet: bool,
    /// Use colors
    #[arg(
        long,
        value_name = "WHEN",
        default_value = "auto",
        global = true,
        hide_possible_values = true,
        help_heading = "Global options"
    )]
    pub color: Color,
}

const AFTER_HELP: &str = "\
Exit status:
  0    success
  1    the program has errors, or the model cannot run it
  2    wrong command line, or a file cannot be read or written
  3    a run did not complete, or runs or shards are missing
  130  interrupted

`stochc COMMAND --help` describes a command.";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Check programs: report errors and warnings, and prove that they finish
    Check(check::CheckArguments),
    /// Check programs, and execute their event tables in every order of events
    Verify(verify::VerifyArguments),
    /// Format programs
    Fmt(fmt::FmtArguments),
    /// Write a program that builds a shape
    Plan(Box<plan::PlanArguments>),
    /// Print a stage of the compilation: structure, graph or event tables
    Compile(compile::CompileArguments),
    /// Explain an error or a warning by its code
    Explain(explain::ExplainArguments),
    /// Simulate programs many times and compare their completion times
    Simulate(Box<simulate::SimulateArguments>),
    /// Simulate programs for several values of scene parameters or settings
    Sweep(Box<sweep::SweepArguments>),
    /// Simulate one run and print all its events
    Trace(Box<trace::TraceArguments>),
    /// Make the runs that an interrupted ensemble lacks, or more runs
    Resume(Box<resume::ResumeArguments>),
    /// Make the runs of a results folder again, with the same settings
    Repeat(Box<repeat::RepeatArguments>),
    /// Estimate completion times from calibrated rates, in milliseconds
    Estimate(estimate::EstimateArguments),
    /// Print the results of a folder
    Show(show::ShowArguments),
    /// Write an HTML report: completion curves, waiting times, comparisons
    Report(report::ReportArguments),
    /// Write an HTML page that replays a run
    Replay(replay::ReplayArguments),
    /// Export the trajectories of a run: Parquet table or glTF animation
    Export(export::ExportArguments),
    /// Measure speed against accuracy of models and time steps
    Trade(trade::TradeArguments),
    /// Measure the rates of a scene, for `--model rate`
    Calibrate(calibrate::CalibrateArguments),
    /// Fit scene parameters to measured times
    Fit(Box<fit::FitArguments>),
    /// Split an ensemble into shards, run them anywhere, and merge them
    Shard(shard::ShardArguments),
    /// Check the integrity of a results folder, and repair it
    Fsck(fsck::FsckArguments),
    /// Start the language server for editors
    Lsp(lsp::LspArguments),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArguments),
    /// Print the manual in the format of `man`
    Man(man::ManArguments),
}

/// Reports what is wrong with a command line, in which a name may hold anything, or prints the help or the version that it asks for.
pub fn report_usage_error(error: clap::Error) -> Result<Exit, Failure> {
    if !error.use_stderr() {
        let help = error.render();
        if output_has_colour() {
            print_drawn(&help.ansi().to_string())?
        } else {
            print_drawn(&help.to_string())?
        }
        return Ok(Exit::Success);
    }
    if error.kind() == ErrorKind::InvalidUtf8 {
        return Err(Failure::usage(no_utf8(std::env::args_os())));
    }
    let mut arguments = std::env::args_os().map(|it| it.to_string_lossy().into_owned());
    let strange = arguments.find(|it| it.contains(is_invisible));
    match strange {
        Some(argument) => Err(Failure::usage(format!(
            "{}; look at `{argument}`, and at `--help`",
            error.kind()
        ))),
        None => with_nearest_option(error).exit(),
    }
}

/// Suggests the option that is nearest to an unknown one, transposed letters counted once: clap takes
/// one that is a prefix.
fn with_nearest_option(mut error: clap::Error) -> clap::Error {
    let text = |kind| error.get(kind).map(ToString::to_string);
    let unknown =
        text(ContextKind::InvalidArg).filter(|_| error.get(ContextKind::SuggestedArg).is_some());
    let Some(unknown) = unknown.filter(|it| it.starts_with("--")) else {
        return error;
    };
    let mut command = Cli::command();
    command.build();
    let mut command = &command;
    for name in std::env::args_os().skip(1) {
        command = command.find_subcommand(name).unwrap_or(command);
    }
    let longs = command.get_arguments().filter_map(|it| it.get_long());
    let distance = |long: &str| strsim::damerau_levenshtein(&unknown[2..], long);
    let length = |long: &str| long.len().abs_diff(unknown.len() - 2);
    let nearest = longs.min_by_key(|long| (distance(long), length(long)));
    if let Some(long) = nearest.filter(|long| distance(long) <= 2) {
        let suggestion = ContextValue::String(format!("--{long}"));
        error.insert(ContextKind::SuggestedArg, suggestion);
    }
    error
}

/// Which arguments are no UTF-8, as it is needed of names and of programs' files.
fn no_utf8(arguments: impl Iterator<Item = OsString>) -> String {
    let strange = arguments.filter(|it| it.to_str().is_none());
    let strange = strange.map(|it| format!("`{}`", visible(&it.to_string_lossy())));
    let strange: Vec<_> = strange.collect();
    format!(
        "{} is not in UTF-8 (\u{fffd} stands for what is not): give the file another name",
        strange.join(", ")
    )
}

/// What the command line says. Numbers below 0 are values and no options, so that each is refused by what it is for.
///
/// # Errors
/// If it says nothing that can be done.
pub fn parse() -> Result<Cli, clap::Error> {
    let negative = |arg: clap::Arg| {
        let takes_values = arg.get_action().takes_values();
        arg.allow_negative_numbers(takes_values)
    };
    let nested = |it: clap::Command| {
        it.mut_args(negative)
            .mut_subcommands(|it| it.mut_args(negative))
    };
    let mut command = Cli::command().mut_subcommands(nested);
    let matches = command
        .try_get_matches_from_mut(std::env::args_os())
        .map_err(about_numbers)?;
    Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// The error of what should be a whole number, in words for people; others as they are.
fn about_numbers(error: clap::Error) -> clap::Error {
    let source = std::error::Error::source(&error);
    let Some(number) = source.and_then(|it| it.downcast_ref::<ParseIntError>()) else {
        return error;
    };
    let words = match number.kind() {
        IntErrorKind::PosOverflow => "the number is too large",
        _ => "a whole number is needed, with digits alone",
    };
    let of = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let [value, option] = [ContextKind::InvalidValue, ContextKind::InvalidArg].map(of);
    clap::Error::raw(
        error.kind(),
        format!(
            "invalid value '{value}' for '{option}': {words}\n\nFor more information, try '--help'.\n"
        ),
    )
}

/// Does what the command line says; what is left to say is in the failure.
pub fn run(cli: Cli) -> Result<Exit, Failure> {
    outlive_file_limit();
    configure(TerminalOptions {
        is_quiet: cli.quiet,
        color: cli.color,
    });
    match cli.command {
        Command::Check(options) => check::run(&options),
        Command::Verify(options) => verify::run(&options),
        Command::Fmt(options) => fmt::run(&options),
        Command::Plan(options) => plan::run(&options),
        Command::Compile(options) => compile::run(&options),
        Command::Explain(options) => explain::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Sweep(options) => sweep::run(&options),
        Command::Trace(options) => trace::run(&options),
        Command::Resume(options) => resume::run(&options),
        Command::Repeat(options) => repeat::run(&options),
        Command::Estimate(options) => estimate::run(&options),
        Command::Show(options) => show::run(&options),
        Command::Report(options) => report::run(&options),
        Command::Replay(options) => replay::run(&options),
        Command::Export(options) => export::run(&options),
        Command::Trade(options) => trade::run(&options),
        Command::Calibrate(options) => calibrate::run(&options),
        Command::Fit(options) => fit::run(&options),
        Command::Shard(options) => shard::run(&options),
        Command::Fsck(options) => fsck::run(&options),
        Command::Lsp(options) => lsp::run(&options),
        Command::Completions(options) => completions::run(&options, Cli::command()),
        Command::Man(options) => man::run(&options, Cli::command()),
    }
}
