//! `stochc replay`.
use std::path::PathBuf;

use clap::Args;

use super::chosen_run::{Choice, choose};
use super::terminal::{Terminal, print};
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};
use crate::operations::replay::write;

/// What `replay` is given.
#[derive(Debug, Args)]
pub struct Options {
    #[command(flatten)]
    choice: Choice,
    /// File to write [default: `DIR/replay-PROGRAM-N.html`]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes the page that shows a run.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    stop_on_interrupt()?;
    let host = Terminal::new(false);
    let chosen = choose(&options.choice, &host)?;
    let path = options.out.clone().unwrap_or_else(|| {
        let name = chosen.file_name("replay-", "html");
        options.choice.folder.join(name)
    });
    write(&chosen, &path, &host)?;
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}
