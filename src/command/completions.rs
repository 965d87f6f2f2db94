//! `stochc completions`.
use clap::Args;
use clap_complete::{Shell, generate};
use stochc_compiler::diagnostic::Code;

use super::terminal::print;
use crate::exit::{Exit, Failure};

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// Shell to print the script for
    shell: Shell,
}

pub fn run(options: &CompletionsArguments, mut command: clap::Command) -> Result<Exit, Failure> {
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    generate(options.shell, &mut command, name, &mut script);
    let mut script = String::from_utf8_lossy(&script).into_owned();
    if options.shell == Shell::Fish {
        script.push_str(&codes_for_fish());
    }
    print(&script)?;
    Ok(Exit::Success)
}

/// Returns the part of the fish script that completes diagnostic codes. The generator of
/// `clap_complete` completes only values of options.
fn codes_for_fish() -> String {
    let codes: Vec<&str> = Code::ALL.iter().map(|code| code.name()).collect();
    let codes = codes.join(" ");
    format!("complete -c stochc -n \"__fish_seen_subcommand_from explain\" -f -a \"{codes}\"\n")
}
