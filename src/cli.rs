//! Command line of `stochc`.
use std::ffi::OsString;
use std::num::{IntErrorKind, ParseIntError};
use std::path::Path;
use std::sync::LazyLock;

use clap::builder::{StyledStr, Styles};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use stochc_files::shell::file as shell_file;
use stochc_results::this_build;
use stochc_text::suggest::nearest;
use stochc_text::{is_invisible, visible};

use crate::command::interrupt::outlive_file_limit;
pub use crate::command::terminal::show_deferred;
use crate::command::terminal::{Color, TerminalOptions, configure, output_has_colour, print_drawn};
use crate::command::{
    calibrate, check, compile, completions, estimate, explain, export, fit, fmt, fsck, import, lsp,
    man, new, optimize, plan, repeat, replay, report, resume, shard, show, simulate, sweep, test,
    trace, trade, verify,
};
use crate::exit::{Exit, Failure};

/// Compiler, verifier and simulator for stochastic modular robots.
#[derive(Debug, Parser)]
#[command(version, long_version = version_and_build(), about, after_help = AFTER_HELP)]
pub struct Cli {
    /// The subcommand.
    #[command(subcommand)]
    pub command: Command,
    /// Print no progress or notes. Warnings and errors are printed
    #[arg(long, short, global = true, help_heading = "Global options")]
    pub quiet: bool,
    /// When to use colors: `auto`, `always` or `never`
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

/// Returns the version with the build that results folders and reports name.
fn version_and_build() -> &'static str {
    static TEXT: LazyLock<String> =
        LazyLock::new(|| format!("{} (build {})", env!("CARGO_PKG_VERSION"), this_build()));
    &TEXT
}

const AFTER_HELP: &str = "\
Exit status:
  0    success
  1    the program has errors, or the model cannot run it
  2    wrong command line, or a file cannot be read or written
  3    a run did not complete, runs or shards are missing, or a program does not survive `--faults`
  130  interrupted

`stochc COMMAND --help` describes a command.";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a commented program to start from
    #[command(after_help = "Examples:\n  stochc new tower\n  stochc new tank --template suction")]
    New(new::NewArguments),
    /// Report errors and warnings, and prove that programs complete
    #[command(
        after_help = "Examples:\n  stochc check tower.sa\n  stochc check tower.sa --fix --dry-run"
    )]
    Check(check::CheckArguments),
    /// Check programs, and execute their event tables in every order of events
    #[command(
        after_help = "Examples:\n  stochc verify tower.sa\n  stochc verify programs/ --states 100000"
    )]
    Verify(verify::VerifyArguments),
    /// Format programs
    #[command(after_help = "Examples:\n  stochc fmt tower.sa\n  stochc fmt --check programs/")]
    Fmt(fmt::FmtArguments),
    /// Write a program that builds a shape
    #[command(
        after_help = "Examples:\n  stochc plan shape.txt -o tower.sa\n  stochc plan castle.vox --time 10s -o castle.sa"
    )]
    Plan(Box<plan::PlanArguments>),
    /// Compile a program, and print its structure, its graph or its event tables
    Compile(compile::CompileArguments),
    /// Explain an error or a warning by its code
    Explain(explain::ExplainArguments),
    /// Simulate programs many times and compare their completion times
    #[command(
        after_help = "Examples:\n  stochc simulate tower.sa -n 100 -o results/tower\n  stochc simulate one.sa other.sa --until 3% -o results/both"
    )]
    Simulate(Box<simulate::SimulateArguments>),
    /// Test the claims of programs by simulation
    #[command(
        after_help = "Exit status:\n  0  All claims hold.\n  1  A program has errors.\n  2  The command line is wrong, or there are no claims.\n  3  A claim fails or is undecided.\n\nExamples:\n  stochc test tower.sa\n  stochc test tower.sa --margin 1% --alpha 1%"
    )]
    Test(Box<test::TestArguments>),
    /// Simulate programs for several values of scene parameters or settings
    #[command(
        after_help = "Examples:\n  stochc sweep tower.sa --vary free=100..500/5 -n 20 -o results/free\n  stochc sweep tower.sa --vary substeps=1,2,4 --vary free=200,400"
    )]
    Sweep(Box<sweep::SweepArguments>),
    /// Simulate one run and print all its events
    #[command(
        after_help = "Examples:\n  stochc trace tower.sa\n  stochc trace tower.sa --run 17 --seed 2"
    )]
    Trace(Box<trace::TraceArguments>),
    /// Simulate the missing runs of an interrupted ensemble, or add runs
    #[command(
        after_help = "Examples:\n  stochc resume results/tower\n  stochc resume results/tower -n 400"
    )]
    Resume(Box<resume::ResumeArguments>),
    /// Simulate the runs of a results folder again, with the same settings
    #[command(
        after_help = "Examples:\n  stochc repeat results/tower -o results/again\n  stochc repeat results/tower --record all -o results/recorded"
    )]
    Repeat(Box<repeat::RepeatArguments>),
    /// Estimate completion times immediately, from calibrated rates and without physics
    #[command(
        after_help = "Examples:\n  stochc estimate tower.sa\n  stochc estimate --remaining results/bench"
    )]
    Estimate(estimate::EstimateArguments),
    /// Print the results of a folder
    #[command(
        after_help = "Examples:\n  stochc show results/tower\n  stochc show results/tower --run 17"
    )]
    Show(show::ShowArguments),
    /// Write an HTML report with completion curves, waiting times and comparisons
    #[command(
        after_help = "Examples:\n  stochc report results/tower\n  stochc report results/one results/other -o report.html"
    )]
    Report(report::ReportArguments),
    /// Write an HTML page that replays a run
    #[command(
        after_help = "Examples:\n  stochc replay results/tower\n  stochc replay results/tower --run 17 --tour"
    )]
    Replay(replay::ReplayArguments),
    /// Export the trajectories of a run as a Parquet table or a glTF animation
    #[command(
        after_help = "Examples:\n  stochc export results/tower -o run.parquet\n  stochc export results/tower --run 17 -o run.glb"
    )]
    Export(export::ExportArguments),
    /// Measure how fast and how accurate models and time steps are
    #[command(
        after_help = "Examples:\n  stochc trade tower.sa -o results/trade\n  stochc trade tower.sa --time 10m"
    )]
    Trade(trade::TradeArguments),
    /// Measure the rates of a scene for `--model rate`
    #[command(
        after_help = "Examples:\n  stochc calibrate hemisphere -o hemisphere.rates\n  stochc calibrate tower.sa -n 20 -o tank.rates"
    )]
    Calibrate(calibrate::CalibrateArguments),
    /// Read the log of a real experiment into a results folder
    #[command(
        after_help = "Examples:\n  stochc import log.csv --program tower.sa -o results/bench\n  stochc import log.jsonl --program towers.sa --assembly tall -o results/tall"
    )]
    Import(import::ImportArguments),
    /// Fit scene parameters to measured times
    #[command(
        after_help = "Examples:\n  stochc fit tower.sa --data times.csv --vary free=50..500\n  stochc fit a.sa b.sa --data times.csv --vary 'bond.pull=2..12 N' --hold-out b"
    )]
    Fit(Box<fit::FitArguments>),
    /// Search for the parameters with the shortest times
    #[command(
        after_help = "Examples:\n  stochc optimize tower.sa --vary 'agitation.speed=0.4..1.2 m/s' --vary free=50..500\n  stochc optimize tower.sa --vary height=2..6 --minimize p90 -o results/best"
    )]
    Optimize(Box<optimize::OptimizeArguments>),
    /// Split an ensemble into shards, run them anywhere, and merge them
    #[command(
        after_help = "Examples:\n  stochc shard new tower.sa --shards 8 -n 1000 -o results/tower\n  stochc shard run results/tower 0"
    )]
    Shard(shard::ShardArguments),
    /// Check the integrity of a results folder, and repair it
    #[command(
        after_help = "Examples:\n  stochc fsck results/tower\n  stochc fsck results/tower --repair"
    )]
    Fsck(fsck::FsckArguments),
    /// Start the language server for editors
    Lsp(lsp::LspArguments),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArguments),
    /// Print the manual in the format of `man`
    Man(man::ManArguments),
}

/// Prints an error of the command line, or the help or version. Escapes invisible characters in the
/// message.
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
        None => {
            let mut error = with_nearest_option(with_command(error));
            // Positional arguments never look like options.
            if error.kind() == ErrorKind::UnknownArgument {
                error.remove(ContextKind::Suggested);
            }
            error.exit()
        }
    }
}

/// Adds a suggestion: the option with the most similar name. A transposition counts as one edit.
/// clap itself would suggest options with a common prefix.
fn with_nearest_option(mut error: clap::Error) -> clap::Error {
    let unknown = error.get(ContextKind::InvalidArg).map(ToString::to_string);
    let unknown = unknown.filter(|_| error.kind() == ErrorKind::UnknownArgument);
    let Some(unknown) = unknown.filter(|it| it.starts_with("--")) else {
        return error;
    };
    let mut command = Cli::command();
    command.build();
    let command = given(&command);
    let longs = command.get_arguments().filter_map(|it| it.get_long());
    let distance = |long: &str| strsim::damerau_levenshtein(&unknown[2..], long);
    let length = |long: &str| long.len().abs_diff(unknown.len() - 2);
    let nearest = longs.min_by_key(|long| (distance(long), length(long)));
    let is_near = |long: &&str| distance(long) <= 2.min(long.len() - 1);
    if let Some(long) = nearest.filter(is_near) {
        let suggestion = ContextValue::String(format!("--{long}"));
        error.insert(ContextKind::SuggestedArg, suggestion);
    }
    error
}

/// Returns the innermost subcommand that the command line names.
fn given(mut command: &clap::Command) -> &clap::Command {
    for name in std::env::args_os().skip(1) {
        command = command.find_subcommand(name).unwrap_or(command);
    }
    command
}

/// Names of commands in other applications, each with the `stochc` command that does the same.
const OTHER_NAMES: [(&str, &str); 13] = [
    ("run", "stochc simulate"),
    ("sim", "stochc simulate"),
    ("init", "stochc new"),
    ("version", "stochc --version"),
    ("build", "stochc compile"),
    ("format", "stochc fmt"),
    ("lint", "stochc check"),
    ("prove", "stochc verify"),
    ("results", "stochc show"),
    ("status", "stochc shard status"),
    ("merge", "stochc shard merge"),
    ("submit", "stochc shard submit"),
    ("continue", "stochc resume"),
];

/// Adds a suggestion for an unknown command: the matching command of [`OTHER_NAMES`], or a command
/// for a file.
fn with_command(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let word = word.clone();
    let other = OTHER_NAMES.iter().find(|(name, _)| *name == word);
    let suggestion = match other {
        Some((_, command)) => (*command).to_owned(),
        None if word.ends_with(".sa") || Path::new(&word).exists() => {
            format!("stochc check {}", shell_file(&word))
        }
        None => {
            // clap lists all similar commands in alphabetical order.
            let command = Cli::command();
            let names = given(&command).get_subcommands();
            let names = names.map(clap::Command::get_name);
            if let Some(suggestion) = nearest(&word, names) {
                let value = ContextValue::Strings(vec![suggestion.word]);
                error.insert(ContextKind::SuggestedSubcommand, value);
            }
            return error;
        }
    };
    error.remove(ContextKind::SuggestedSubcommand);
    let tip = StyledStr::from(format!("did you mean `{suggestion}`?"));
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip]));
    error
}

/// Returns the message about arguments that are not UTF-8. Names and paths of programs must be
/// UTF-8.
fn no_utf8(arguments: impl Iterator<Item = OsString>) -> String {
    let strange = arguments.filter(|it| it.to_str().is_none());
    let strange = strange.map(|it| format!("`{}`", visible(&it.to_string_lossy())));
    let strange: Vec<_> = strange.collect();
    format!(
        "{} is not in UTF-8 (\u{fffd} replaces invalid bytes): rename the file",
        strange.join(", ")
    )
}

/// Parses the command line. Negative numbers count as values, so that each option can reject them
/// itself.
///
/// # Errors
/// If the command line is invalid, or requests the help or version.
pub fn parse() -> Result<Cli, clap::Error> {
    let negative = |arg: clap::Arg| {
        let takes_values = arg.get_action().takes_values();
        arg.allow_negative_numbers(takes_values)
    };
    let nested = |it: clap::Command| {
        it.mut_args(negative)
            .mut_subcommands(|it| it.mut_args(negative))
    };
    let command = Cli::command().mut_subcommands(nested);
    let template = help_template(&command);
    let mut command = command.help_template(template).max_term_width(100);
    let matches = command
        .try_get_matches_from_mut(std::env::args_os())
        .map_err(about_numbers)?;
    Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// Groups of subcommands in the help, each with a title.
const GROUPS: [(&str, &[&str]); 6] = [
    (
        "Write",
        &[
            "new", "check", "verify", "fmt", "plan", "compile", "explain",
        ],
    ),
    (
        "Run",
        &[
            "simulate", "test", "sweep", "optimize", "trace", "resume", "repeat", "estimate",
        ],
    ),
    ("Look", &["show", "report", "replay", "export"]),
    ("Trust", &["trade", "calibrate", "import", "fit"]),
    ("Many machines", &["shard"]),
    ("Keep", &["fsck", "lsp", "completions", "man"]),
];

/// Returns the template of the help, with the subcommands in groups.
fn help_template(command: &clap::Command) -> String {
    let styles = Styles::default();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let mut groups = String::new();
    for (group, names) in GROUPS {
        groups += &format!("{header}{group}:{header:#}\n");
        for name in names {
            let about = command.find_subcommand(name).and_then(|it| it.get_about());
            let about = about.map(ToString::to_string).unwrap_or_default();
            groups += &format!("  {literal}{name:12}{literal:#}{about}\n");
        }
        groups += "\n";
    }
    format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}{header}Options:{header:#}\n{{options}}{{after-help}}"
    )
}

/// Returns a clearer error about an invalid integer. Returns other errors unchanged.
fn about_numbers(error: clap::Error) -> clap::Error {
    let source = std::error::Error::source(&error);
    let Some(number) = source.and_then(|it| it.downcast_ref::<ParseIntError>()) else {
        return error;
    };
    let of = |kind| error.get(kind).map(ToString::to_string).unwrap_or_default();
    let [value, option] = [ContextKind::InvalidValue, ContextKind::InvalidArg].map(of);
    let words = match number.kind() {
        IntErrorKind::PosOverflow => "the number is too large",
        _ if option.contains("<TICKS>") => "a number of ticks is needed, with digits alone",
        _ => "a whole number is needed, with digits alone",
    };
    clap::Error::raw(
        error.kind(),
        format!(
            "invalid value '{value}' for '{option}': {words}\n\nFor more information, try '--help'.\n"
        ),
    )
}

/// Runs the command. A failure contains the message to print.
pub fn run(cli: Cli) -> Result<Exit, Failure> {
    outlive_file_limit();
    configure(TerminalOptions {
        is_quiet: cli.quiet,
        color: cli.color,
    });
    match cli.command {
        Command::New(options) => new::run(&options),
        Command::Check(options) => check::run(&options),
        Command::Verify(options) => verify::run(&options),
        Command::Fmt(options) => fmt::run(&options),
        Command::Plan(options) => plan::run(&options),
        Command::Compile(options) => compile::run(&options),
        Command::Explain(options) => explain::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Test(options) => test::run(&options),
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
        Command::Import(options) => import::run(&options),
        Command::Fit(options) => fit::run(&options),
        Command::Optimize(options) => optimize::run(&options),
        Command::Shard(options) => shard::run(&options),
        Command::Fsck(options) => fsck::run(&options),
        Command::Lsp(options) => lsp::run(&options),
        Command::Completions(options) => completions::run(&options, Cli::command()),
        Command::Man(options) => man::run(&options, Cli::command()),
    }
}
