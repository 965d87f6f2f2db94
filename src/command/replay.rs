//! `stochc replay`.
use std::io;
use std::path::PathBuf;

use clap::Args;
use stochc_ensemble::text::visible;
use stochc_files::atomic::{Draft, Replaces, begins_with};
use stochc_report::replay::{MARK, about, write};

use super::chosen_run::{Choice, ChosenRun, choose};
use super::terminal::print;
use crate::command::interrupt::stop_on_interrupt;
use crate::exit::{Exit, Failure};

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
    let stop = stop_on_interrupt()?;
    let chosen = choose(&options.choice)?;
    let path = options.out.clone().unwrap_or_else(|| {
        let name = chosen.file_name("replay-", "html");
        options.choice.folder.join(name)
    });
    let cannot = |error| Failure::usage(format!("cannot write `{}`: {error}", path.display()));
    // Before the run, which may take long.
    let ours = Replaces::Ours(|file| begins_with(file, MARK.as_bytes()));
    let out = Draft::new(&path, ours).map_err(cannot)?;
    let recording = chosen.recording(stop)?;
    page(out, &chosen, recording).map_err(cannot)?;
    print(&format!("{}\n", path.display()))?;
    Ok(Exit::Success)
}

/// Writes the page as a whole or not at all.
fn page(mut out: Draft, chosen: &ChosenRun, recording: impl io::Read) -> io::Result<()> {
    let program = chosen.entry();
    let title = format!("{}, run {}", visible(&program.name), chosen.run);
    let about = about(&chosen.manifest, program);
    write(&title, &about, recording, &mut out)?;
    out.keep()
}
