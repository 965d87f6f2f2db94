//! The `stochc` command.
use std::process::ExitCode;

use clap::Parser as _;
use stochc::cli::{Cli, run};

fn main() -> ExitCode {
    ExitCode::from(run(Cli::parse()).status())
}
