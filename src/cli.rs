//! The command line.
use clap::{Parser, Subcommand};

use crate::command::{
    check, compile, completions, explain, export, fmt, lsp, man, replay, report, results, simulate,
    trade,
};

/// Compiler, verifier and simulator for stochastic modular robots.
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXIT_STATUS)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_STATUS: &str = "\
Exit status: 0 all is well, 1 the program is wrong, 2 the command line is wrong or a file cannot \
be read or written, 3 a run was unsuccessful, 4 no setting is known to be accurate enough, 130 interrupted.";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say all that can be said about programs before anything moves
    Check(check::Options),
    /// Lay out programs in the one canonical way
    Fmt(fmt::Options),
    /// Show a stage of the compilation: the syntax tree, the dependency graph, or the event tables
    Compile(compile::Options),
    /// Run programs many times in their physical world, and compare them
    Simulate(Box<simulate::Options>),
    /// Measure what accuracy costs: programs at many settings, against a converged reference
    Trade(trade::Options),
    /// Show the table of a folder that `simulate` has filled
    Results(results::Options),
    /// Write a page on folders that `simulate` has filled: curves, bottlenecks, what decided a run
    Report(report::Options),
    /// Show a run: a page to watch it in, tick by tick
    Replay(replay::Options),
    /// Write the ways of a run's blocks for other programs: a table, or an animation
    Export(export::Options),
    /// Explain a finding by its code
    Explain(explain::Options),
    /// Serve an editor: findings as you type, definitions, renaming (the Language Server Protocol)
    Lsp(lsp::Options),
    /// Print a script that lets a shell complete the command line
    Completions(completions::Options),
    /// Print the manual, in the form that `man` reads
    Man(man::Options),
}

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All is well.
    Success,
    /// The program is wrong.
    WrongProgram,
    /// The command line is wrong, or a file cannot be read or written.
    Usage,
    /// A run was unsuccessful.
    UnsuccessfulRun,
    /// No setting that was measured is as accurate as was asked for.
    NotAccurate,
    /// Stopped by the user.
    Interrupted,
}

impl Exit {
    /// The number that the shell sees.
    pub const fn status(self) -> u8 {
        match self {
            Exit::Success => 0,
            Exit::WrongProgram => 1,
            Exit::Usage => 2,
            Exit::UnsuccessfulRun => 3,
            Exit::NotAccurate => 4,
            Exit::Interrupted => 130,
        }
    }
}

/// Does what the command line says.
pub fn run(cli: Cli) -> Exit {
    match cli.command {
        Command::Check(options) => check::run(&options),
        Command::Fmt(options) => fmt::run(&options),
        Command::Compile(options) => compile::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Trade(options) => trade::run(&options),
        Command::Results(options) => results::run(&options),
        Command::Report(options) => report::run(&options),
        Command::Replay(options) => replay::run(&options),
        Command::Export(options) => export::run(&options),
        Command::Explain(options) => explain::run(&options),
        Command::Lsp(options) => lsp::run(&options),
        Command::Completions(options) => completions::run(&options),
        Command::Man(options) => man::run(&options),
    }
}
