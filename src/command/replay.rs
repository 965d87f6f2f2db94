//! `stochc replay`.
use std::path::PathBuf;

use clap::Args;

use super::chosen_run::{RunSelection, choose};
use super::host::Terminal;
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};
use crate::operations::replay::{View, write};

/// Arguments of `replay`.
#[derive(Debug, Args)]
pub struct ReplayArguments {
    #[command(flatten)]
    choice: RunSelection,
    /// Number of another run of the same program, which is shown next to the first run
    #[arg(long, value_name = "N")]
    against: Option<u64>,
    /// Start the page with a tour of the critical path
    #[arg(long)]
    tour: bool,
    /// File to write [default: `DIR/replay-PROGRAM-N.html`, or `DIR/replay-PROGRAM-N-against-N.html`]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub fn run(options: &ReplayArguments) -> Result<Exit, Failure> {
    stop_on_interrupt()?;
    let host = Terminal::default();
    let chosen = choose(&options.choice, &host)?;
    let other = match options.against {
        Some(run) if run == chosen.run => {
            return Err(Failure::usage(format!(
                "`--against {run}` needs another run than {run}"
            )));
        }
        Some(run) => {
            let choice = RunSelection {
                run: Some(run),
                ..options.choice.clone()
            };
            Some(choose(&choice, &host)?)
        }
        None => None,
    };
    let path = options.out.clone().unwrap_or_else(|| {
        let beside = options.against.map(|run| format!("-against-{run}"));
        let ending = format!("{}.html", beside.unwrap_or_default());
        let name = chosen.file_name("replay-", &ending);
        options.choice.folder.join(name)
    });
    let view = View {
        beside: other.as_ref(),
        is_guided: options.tour,
    };
    write(&chosen, &view, &path, &host)?;
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}
