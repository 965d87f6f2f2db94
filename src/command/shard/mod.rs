//! `stochc shard`: ensembles that are split so that several machines can run them.
mod merge;
mod new;
mod run;
mod status;
mod submit;

use clap::{Args, Subcommand};

use crate::exit::{Exit, Failure};

/// Arguments of `shard`.
#[derive(Debug, Args)]
pub struct ShardArguments {
    #[command(subcommand)]
    command: ShardCommand,
}

/// The subcommands of `shard`.
#[derive(Debug, Subcommand)]
enum ShardCommand {
    /// Split an ensemble into shards
    New(Box<new::NewArguments>),
    /// Make the runs of one shard
    Run(run::RunArguments),
    /// List the shards of an ensemble and their states
    Status(status::StatusArguments),
    /// Merge shards into the results folder that one machine would have made
    Merge(merge::MergeArguments),
    /// Submit missing shards and a merge job to Slurm
    Submit(submit::SubmitArguments),
}

/// Runs the chosen subcommand.
pub fn run(options: &ShardArguments) -> Result<Exit, Failure> {
    match &options.command {
        ShardCommand::New(options) => new::run(options),
        ShardCommand::Run(options) => run::run(options),
        ShardCommand::Status(options) => status::run(options),
        ShardCommand::Merge(options) => merge::run(options),
        ShardCommand::Submit(options) => submit::run(options),
    }
}
